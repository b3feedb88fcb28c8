//! Two meshes: the middle of the longest crossing of two triangles.

use elbowroom_spatial::{Pose, Vec3};

use super::{ContactPoint, nearest, outward, swallowed, unknown};
use crate::mesh::{Pair, Scratch, contacts};
use crate::triangle::{segment_crosses, triangle_triangle};
use crate::{Shape, TriMesh};

/// The longest crossing so far, in one frame.
#[derive(Debug)]
pub(super) struct Longest {
    /// Lengths that differ by less are equal, metres.
    grain: f64,
    best: Option<Crossing>,
}

/// Where two triangles meet.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crossing {
    /// Length of the segment in grains; 0 where they only touch.
    length: f64,
    /// The two numbers, smaller first, then as they are: the same whichever mesh comes first.
    order: (u32, u32),
    pub triangles: (u32, u32),
    pub on_a: Vec3,
    pub on_b: Vec3,
}

impl Longest {
    /// For shapes of such a size, metres.
    pub fn new(size: f64) -> Self {
        Self { grain: (1e-9 * size).max(f64::MIN_POSITIVE), best: None }
    }

    pub fn offer(&mut self, (s, t): ([Vec3; 3], [Vec3; 3]), triangles: (u32, u32)) {
        let (length, on_a, on_b) = if let Some((p, q)) = crossing(&s, &t) {
            let middle = (p + q) * 0.5;
            (p.distance(q), middle, middle)
        } else {
            let near = triangle_triangle(s, t);
            (0.0, near.on_a, near.on_b)
        };
        let length = (length / self.grain).round();
        let order = (triangles.0.min(triangles.1), triangles.0.max(triangles.1));
        let before = |b: &Crossing| length > b.length || (length == b.length && order < b.order);
        if self.best.as_ref().is_none_or(before) {
            self.best = Some(Crossing { length, order, triangles, on_a, on_b });
        }
    }

    pub fn found(self) -> Option<Crossing> {
        self.best
    }
}

/// The segment that two triangles have in common; `None` where no edge of one passes through the other.
pub(super) fn crossing(s: &[Vec3; 3], t: &[Vec3; 3]) -> Option<(Vec3, Vec3)> {
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

/// Where two meshes meet, or are nearest within the limit.
pub(super) fn meet(
    (a, a_in_world): (&TriMesh, &Pose),
    (b, b_in_world): (&TriMesh, &Pose),
    (shape_a, shape_b): (&Shape, &Shape),
    limit: f64,
    scratch: &mut Scratch,
) -> Option<ContactPoint> {
    let b_in_a = a_in_world.inverse_mul(b_in_world);
    let size = a.aabb().extent().max_element() + b.aabb().extent().max_element();
    let (mut longest, mut other) = (Longest::new(size), None);
    contacts(a, a_in_world, b, b_in_world, scratch, |pair| match pair {
        Pair::Triangles(x, y) => {
            let t = b.corners(y as usize).map(|p| b_in_a.transform_point(p));
            longest.offer((a.corners(x as usize), t), (x, y));
        }
        pair => other = Some(pair),
    });
    if let Some(c) = longest.found() {
        let (on_a, on_b) = (a_in_world.transform_point(c.on_a), a_in_world.transform_point(c.on_b));
        let at_b = b_in_world.inverse_transform_point(on_b);
        let (x, y) = c.triangles;
        let normal_a = a_in_world.transform_vector(outward(a, x as usize, c.on_a, Vec3::Z));
        let away = b_in_world.inverse_transform_vector(-normal_a);
        return Some(ContactPoint {
            on_a,
            on_b,
            normal_a,
            normal_b: b_in_world.transform_vector(outward(b, y as usize, at_b, away)),
            triangle_a: Some(x),
            triangle_b: Some(y),
            touching: true,
        });
    }
    match other {
        Some(Pair::Inside) => Some(swallowed((shape_a, a_in_world), (shape_b, b_in_world))),
        Some(_) => Some(unknown(a_in_world, b_in_world)),
        None => nearest((shape_a, a_in_world), (shape_b, b_in_world), limit),
    }
}
