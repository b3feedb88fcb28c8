//! Steady witness points: where faces or edges lie parallel, or nearly so, many pairs of points are as near as the nearest
//! to within a hair, and rounding would choose among them.
//!
//! Among the pairs that are no farther apart than the least distance and [`GRAIN`] of the sizes, the one nearest to a given
//! point is told. That point lies between the middles of the two shapes, near that of the smaller, and moves with them; so
//! for flat faces the answer is the middle of where they face each other, or the part of it that is nearest.

use elbowroom_spatial::Vec3;

use crate::triangle::{nearest_on_segment, nearest_on_triangle};

/// Gaps that differ by less than this share of the sizes (the radii of both shapes together) are as good as equal.
pub(crate) const GRAIN: f64 = 1e-8;
/// A patch smaller than this share of the sizes is a point.
pub(crate) const SMALL: f64 = 1e-3;

/// Corners of a polygon at most: a face of eight and what sixteen cuts add.
const MOST: usize = 24;

/// A flat convex polygon.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Polygon {
    points: [Vec3; MOST],
    len: usize,
}

impl Polygon {
    /// Of up to eight corners in order.
    pub fn new(corners: impl IntoIterator<Item = Vec3>) -> Self {
        let mut polygon = Self { points: [Vec3::ZERO; MOST], len: 0 };
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

    /// The part with `normal · p <= most` (Sutherland and Hodgman, 1974).
    fn clipped(&self, normal: Vec3, most: f64) -> Self {
        let mut kept = Self { points: [Vec3::ZERO; MOST], len: 0 };
        for (k, &p) in self.points().iter().enumerate() {
            let q = self.points[if k + 1 == self.len { 0 } else { k + 1 }];
            let (hp, hq) = (normal.dot(p) - most, normal.dot(q) - most);
            if hp <= 0.0 {
                kept.push(p);
            }
            if (hp < 0.0 && hq > 0.0) || (hp > 0.0 && hq < 0.0) {
                kept.push(p + (q - p) * (hp / (hp - hq)));
            }
        }
        kept
    }

    /// The part that lies over the other along the unit vector `along`, or beside it by `grain` at most.
    fn over(&self, other: &Self, along: Vec3, grain: f64) -> Self {
        let side = if along.x.abs() < 0.6 { Vec3::X } else { Vec3::Y };
        let u = along.cross(side);
        let mut kept = self.between(other, u, grain).between(other, along.cross(u), grain);
        for (k, &p) in other.points().iter().enumerate() {
            let q = other.points[if k + 1 == other.len { 0 } else { k + 1 }];
            kept = kept.between(other, along.cross(q - p), grain);
        }
        kept
    }

    /// The part within the extent of the other along a direction.
    fn between(&self, other: &Self, direction: Vec3, grain: f64) -> Self {
        let Some(n) = direction.try_normalize() else { return *self };
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for p in other.points() {
            let h = n.dot(*p);
            (low, high) = (low.min(h), high.max(h));
        }
        self.clipped(n, high + grain).clipped(-n, grain - low)
    }

    /// About its largest extent: that from its first corner.
    fn size(&self) -> f64 {
        self.points().iter().fold(0.0, |most: f64, p| most.max(p.distance(self.points[0])))
    }

    /// The point nearest to `p`; `None` for a polygon without corners.
    fn nearest(&self, p: Vec3) -> Option<Vec3> {
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

/// What pairs of faces are compared by.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facing {
    /// Unit vector from the first shape to the second.
    pub along: Vec3,
    /// How far the first shape reaches along it, and where the second begins.
    pub ends: [f64; 2],
    /// See [`GRAIN`], as a length.
    pub grain: f64,
    /// Of all pairs the one nearest to this is told.
    pub middle: Vec3,
}

impl Facing {
    /// The pair of points, one on each face, that are no farther than the grain from the ends, opposite each other, and
    /// nearest to the middle; and how far apart such points lie.
    pub fn pair(&self, of_a: &Polygon, of_b: &Polygon) -> Option<(Vec3, Vec3, f64)> {
        let top = of_a.clipped(-self.along, self.grain - self.ends[0]);
        let bottom = of_b.clipped(self.along, self.ends[1] + self.grain);
        let patch = top.over(&bottom, self.along, self.grain);
        let on_a = patch.nearest(self.middle)?;
        let on_b = bottom.nearest(on_a + self.along * (self.ends[1] - self.along.dot(on_a)))?;
        Some((on_a, on_b, patch.size()))
    }
}

/// What of a shape lies within the grain of its farthest point along a direction.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Wide {
    /// Not more than a point.
    Point,
    /// An edge along this unit vector, and how wide it is, metres.
    Edge(Vec3, f64),
    /// More than an edge.
    Face,
}

impl Wide {
    /// Of the convex hull of `points`, the farthest of which is `top`.
    pub fn of(points: impl Iterator<Item = Vec3>, top: Vec3, along: Vec3, grain: f64, small: f64) -> Self {
        let mut found = Self::Point;
        let mut width: f64 = 0.0;
        for p in points {
            let (step, drop) = (p - top, (top - p).dot(along));
            let length = step.length();
            if !(length > small && drop * small < grain * length) {
                width = if length > small { width.max(grain * length / drop) } else { width.max(length) };
                continue;
            }
            match found {
                Self::Point => found = Self::Edge(step / length, 0.0),
                Self::Edge(u, _) if u.cross(step).length() <= small => {}
                _ => return Self::Face,
            }
        }
        if let Self::Edge(u, _) = found { Self::Edge(u, width) } else { found }
    }

    /// True where points of both may face each other over more than `small`.
    pub fn meets(self, other: Self, grain: f64, small: f64) -> bool {
        match (self, other) {
            (Self::Point, _) | (_, Self::Point) => false,
            (Self::Edge(u, wide), Self::Edge(v, also)) => {
                u.cross(v).length() * small <= 2.0 * (wide + also) + 4.0 * grain
            }
            _ => true,
        }
    }
}

/// From a point of the patch to the nearest points beside it, by projections to and fro: they take away what the grain let
/// in where faces are steep, and leave the points where they are where faces are parallel.
pub(crate) fn settled(on_a: Vec3, onto_a: &dyn Fn(Vec3) -> Vec3, onto_b: &dyn Fn(Vec3) -> Vec3) -> (Vec3, Vec3) {
    let mut on_a = on_a;
    for _ in 0..3 {
        on_a = onto_a(onto_b(on_a));
    }
    (on_a, onto_b(on_a))
}

/// Between two middles, near that of the smaller shape: continuous in all of them, and the same either way round.
pub(crate) fn between(a: Vec3, radius_a: f64, b: Vec3, radius_b: f64) -> Vec3 {
    let (wa, wb) = (radius_b * radius_b, radius_a * radius_a);
    let sum = wa + wb;
    if sum > 0.0 { a * (wa / sum) + b * (wb / sum) } else { a }
}
