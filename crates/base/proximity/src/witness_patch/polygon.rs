//! Flat convex polygons: clipping, overlap, nearest point.

use elbowroom_spatial::Vec3;

use crate::triangle::{nearest_on_segment, nearest_on_triangle};

/// Largest number of corners of a polygon: a face of eight, and one more for each of sixteen cuts.
const MAX_CORNERS: usize = 24;

/// A flat convex polygon.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Polygon {
    points: [Vec3; MAX_CORNERS],
    len: usize,
}

impl Polygon {
    /// Creates a polygon from up to eight corners in order.
    pub fn new(corners: impl IntoIterator<Item = Vec3>) -> Self {
        let mut polygon = Self { points: [Vec3::ZERO; MAX_CORNERS], len: 0 };
        corners.into_iter().take(8).for_each(|p| polygon.push(p));
        polygon
    }

    fn push(&mut self, p: Vec3) {
        if let Some(slot) = self.points.get_mut(self.len) {
            (*slot, self.len) = (p, self.len + 1);
        }
    }

    fn points(&self) -> &[Vec3] {
        &self.points[..self.len]
    }

    /// Whether nothing is left of it.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The part with `normal · p <= limit`.
    pub fn clipped(mut self, normal: Vec3, limit: f64) -> Self {
        self.clip(normal, limit);
        self
    }

    /// Keeps the part with `normal · p <= limit` (Sutherland and Hodgman, 1974). Most cuts leave the polygon as it is, and
    /// copy nothing.
    fn clip(&mut self, normal: Vec3, limit: f64) {
        let height = |p: Vec3| normal.dot(p) - limit;
        if self.points().iter().all(|&p| height(p) <= 0.0) {
            return;
        }
        let mut kept = Self::new([]);
        for (k, &p) in self.points().iter().enumerate() {
            let q = self.points[if k + 1 == self.len { 0 } else { k + 1 }];
            let (hp, hq) = (height(p), height(q));
            if hp <= 0.0 {
                kept.push(p);
            }
            if (hp < 0.0 && hq > 0.0) || (hp > 0.0 && hq < 0.0) {
                kept.push(p + (q - p) * (hp / (hp - hq)));
            }
        }
        self.len = kept.len;
        self.points[..kept.len].copy_from_slice(kept.points());
    }

    /// The overlap with the other polygon, both projected along the unit vector `along`, enlarged by `tolerance`.
    pub fn overlap(mut self, other: &Self, along: Vec3, tolerance: f64) -> Self {
        let side = if along.x.abs() < 0.6 { Vec3::X } else { Vec3::Y };
        let u = along.cross(side);
        self.clip_to_extent(other, u, tolerance);
        self.clip_to_extent(other, along.cross(u), tolerance);
        for (k, &p) in other.points().iter().enumerate() {
            let q = other.points[if k + 1 == other.len { 0 } else { k + 1 }];
            self.clip_to_extent(other, along.cross(q - p), tolerance);
        }
        self
    }

    /// Keeps the part within the extent of the other polygon along a direction, enlarged by `tolerance`.
    fn clip_to_extent(&mut self, other: &Self, direction: Vec3, tolerance: f64) {
        if self.is_empty() {
            return;
        }
        let Some(n) = direction.try_normalize() else { return };
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in other.points() {
            let h = n.dot(*p);
            (low, high) = (low.min(h), high.max(h));
        }
        self.clip(n, high + tolerance);
        self.clip(-n, tolerance - low);
    }

    /// Approximately the largest extent: the largest distance of a corner from the first.
    pub fn size(&self) -> f64 {
        self.points().iter().fold(0.0, |size: f64, p| size.max(p.distance(self.points[0])))
    }

    /// The point nearest to `p`; `None` for a polygon without corners.
    pub fn nearest(&self, p: Vec3) -> Option<Vec3> {
        let points = self.points();
        let candidates = |i: usize| match points.len() {
            1 => points[0],
            2 => nearest_on_segment(p, points[0], points[1]),
            _ => nearest_on_triangle(p, [points[0], points[i + 1], points[i + 2]]),
        };
        let count = points.len().min(1).max(points.len().saturating_sub(2));
        (0..count).map(candidates).min_by(|x, y| (*x - p).length_squared().total_cmp(&(*y - p).length_squared()))
    }
}
