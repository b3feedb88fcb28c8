//! Shapes without their rounding: a sphere is a point with a radius, a capsule a segment with a radius.

use elbowroom_spatial::Vec3;

use crate::shape::hull::farthest;
use crate::{ConvexHull, Cuboid, Cylinder, Shape};

/// What is left of a convex shape when its rounding radius is taken off.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Core<'a> {
    Point,
    /// Along z, half length.
    Segment(f64),
    Cylinder(Cylinder),
    Cuboid(Cuboid),
    Hull(&'a ConvexHull),
    /// The convex hull of points.
    Points(&'a [Vec3]),
    Triangle([Vec3; 3]),
}

/// Core and radius of a convex and bounded shape.
#[inline]
pub(crate) fn rounded(shape: &Shape) -> Option<(Core<'_>, f64)> {
    Some(match shape {
        Shape::Sphere(s) => (Core::Point, s.radius),
        Shape::Capsule(c) => (Core::Segment(c.half_length), c.radius),
        Shape::Cylinder(c) => (Core::Cylinder(*c), 0.0),
        Shape::Cuboid(c) => (Core::Cuboid(*c), 0.0),
        Shape::Hull(h) => (Core::Hull(h), 0.0),
        Shape::HalfSpace(_) | Shape::Mesh(_) => return None,
    })
}

impl Core<'_> {
    /// The point farthest along `dir`, local frame.
    #[inline]
    pub fn support(&self, dir: Vec3) -> Vec3 {
        match self {
            Self::Point => Vec3::ZERO,
            Self::Segment(h) => Vec3::Z * h.copysign(dir.z),
            Self::Cylinder(c) => c.support(dir),
            Self::Cuboid(c) => c.support(dir),
            Self::Hull(h) => h.support(dir),
            Self::Points(p) => farthest(p, dir),
            Self::Triangle(t) => farthest(t, dir),
        }
    }

    /// Some point of the core, near its middle where that is cheap, local frame.
    #[inline]
    pub fn middle(&self) -> Vec3 {
        match self {
            Self::Hull(h) => h.aabb().center(),
            Self::Points(p) => p.first().copied().unwrap_or(Vec3::ZERO),
            Self::Triangle([a, b, c]) => (*a + *b + *c) / 3.0,
            _ => Vec3::ZERO,
        }
    }

    /// Largest coordinate that occurs in it, metres: the scale of its rounding errors.
    #[inline]
    pub fn size(&self) -> f64 {
        match self {
            Self::Point => 0.0,
            Self::Segment(h) => *h,
            Self::Cylinder(c) => c.half_length + c.radius,
            Self::Cuboid(c) => c.half_extents.x + c.half_extents.y + c.half_extents.z,
            Self::Hull(h) => h.aabb().min.abs().max(h.aabb().max.abs()).max_element(),
            Self::Points(p) => p.iter().fold(0.0, |m: f64, v| m.max(v.abs().max_element())),
            Self::Triangle(t) => t.iter().fold(0.0, |m: f64, v| m.max(v.abs().max_element())),
        }
    }

    /// Extent along a local direction: the largest `dir · p`.
    #[inline]
    pub fn reach(&self, dir: Vec3) -> f64 {
        self.support(dir).dot(dir)
    }
}

/// Nearest points of two cores in the frame of the second, the distance, and a proven bound below it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap {
    pub distance: f64,
    /// Distance of the two points. Steady ones may be farther apart than the least distance, by what is as good as equal.
    pub apart: f64,
    pub lower: f64,
    pub on_a: Vec3,
    pub on_b: Vec3,
}

impl Gap {
    /// From witness points of a method whose only error is rounding of numbers up to `scale`.
    #[inline]
    pub fn closed(on_a: Vec3, on_b: Vec3, scale: f64) -> Self {
        let distance = (on_a - on_b).length();
        Self { distance, apart: distance, lower: (distance - rounding(scale)).max(0.0), on_a, on_b }
    }

    #[inline]
    pub fn touching(on_a: Vec3, on_b: Vec3) -> Self {
        Self { distance: 0.0, apart: 0.0, lower: 0.0, on_a, on_b }
    }

    /// True where cores are proven to be farther apart than their radii, together: shapes do not touch.
    #[inline]
    pub fn is_beyond(&self, radii: f64) -> bool {
        self.lower - radii - rounding(radii) > 0.0
    }

    /// With a proof of another kind: what is proven apart does not touch, whatever rounding makes of the points.
    #[inline]
    pub fn at_least(self, proven: f64) -> Self {
        let lower = self.lower.max(proven);
        let raised = || (self.on_a - self.on_b).length().max(lower);
        let distance = if self.distance < lower { raised() } else { self.distance };
        Self { lower, distance, apart: self.apart.max(distance), ..self }
    }
}

/// What the last places of a short computation on numbers up to `scale` may be worth.
#[inline]
pub(crate) fn rounding(scale: f64) -> f64 {
    16.0 * f64::EPSILON * scale
}
