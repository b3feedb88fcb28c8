//! The segment in which two triangles cross.

use elbowroom_spatial::Vec3;

use crate::triangle::{segment_crosses, triangle_triangle};

/// The longest crossing so far; all triangles are in one frame.
#[derive(Debug)]
pub(super) struct LongestCrossing {
    /// Lengths that differ by less count as equal, metres.
    resolution: f64,
    best: Option<Crossing>,
}

/// The place where two triangles meet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    /// Length of the segment in units of the resolution; 0 if the triangles only touch.
    length: f64,
    /// The two indices, smaller first, to break ties independently of the order of the shapes.
    order: (u32, u32),
    pub triangles: (u32, u32),
    pub on_a: Vec3,
    pub on_b: Vec3,
}

impl LongestCrossing {
    /// Creates the search for shapes of this size, metres.
    pub fn new(size: f64) -> Self {
        Self { resolution: (1e-9 * size).max(f64::MIN_POSITIVE), best: None }
    }

    pub fn offer(&mut self, s: [Vec3; 3], t: [Vec3; 3], triangles: (u32, u32)) {
        let (length, on_a, on_b) = if let Some((p, q)) = crossing(&s, &t) {
            let middle = (p + q) * 0.5;
            (p.distance(q), middle, middle)
        } else {
            let near = triangle_triangle(s, t);
            (0.0, near.on_a, near.on_b)
        };
        let length = (length / self.resolution).round();
        let order = (triangles.0.min(triangles.1), triangles.0.max(triangles.1));
        let precedes = |b: &Crossing| length > b.length || (length == b.length && order < b.order);
        if self.best.as_ref().is_none_or(precedes) {
            self.best = Some(Crossing { length, order, triangles, on_a, on_b });
        }
    }

    pub fn found(self) -> Option<Crossing> {
        self.best
    }
}

/// The ends of the segment in which two touching triangles cross; their nearest points if they do not cross.
pub(super) fn triangles_meet(s: &[Vec3; 3], t: &[Vec3; 3]) -> (Vec3, Vec3) {
    crossing(s, t).unwrap_or_else(|| {
        let near = triangle_triangle(*s, *t);
        (near.on_a, near.on_b)
    })
}

/// The segment that two triangles have in common; `None` if no edge of one passes through the other.
fn crossing(s: &[Vec3; 3], t: &[Vec3; 3]) -> Option<(Vec3, Vec3)> {
    let edges = |s: &[Vec3; 3], k: usize| (s[k], s[(k + 1) % 3]);
    let mut points = [Vec3::ZERO; 6];
    let mut count = 0;
    for (s, t) in [(s, t), (t, s)] {
        for k in 0..3 {
            let (p, q) = edges(s, k);
            if let Some(x) = segment_crosses(p, q, *t) {
                points[count] = x;
                count += 1;
            }
        }
    }
    let points = &points[..count];
    let mut ends = (*points.first()?, *points.first()?);
    for (i, p) in points.iter().enumerate() {
        for q in &points[i + 1..] {
            if p.distance(*q) > ends.0.distance(ends.1) {
                ends = (*p, *q);
            }
        }
    }
    Some(ends)
}
