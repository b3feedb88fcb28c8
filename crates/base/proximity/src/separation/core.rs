//! Convex cores: shapes without their rounding. A sphere is a point with a radius, a capsule a segment with a radius.

use elbowroom_spatial::{Aabb, Vec3};

use crate::shape::hull::farthest;
use crate::{ConvexHull, Cuboid, Cylinder, Shape};

/// A convex shape without its rounding radius.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Core<'a> {
    Point,
    /// A segment along z, by its half length.
    Segment(f64),
    Cylinder(Cylinder),
    Cuboid(Cuboid),
    Hull(&'a ConvexHull),
    /// The convex hull of points.
    Points(&'a [Vec3]),
    Triangle([Vec3; 3]),
}

/// Core and radius of a bounded convex shape.
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
    /// The support point: the point farthest along `dir`, local frame.
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

    /// A point near the centre of the core, local frame.
    #[inline]
    pub fn middle(&self) -> Vec3 {
        match self {
            Self::Hull(h) => h.aabb().center(),
            Self::Points(p) => p.first().copied().unwrap_or(Vec3::ZERO),
            Self::Triangle([a, b, c]) => (*a + *b + *c) / 3.0,
            _ => Vec3::ZERO,
        }
    }

    /// Bound of the core's coordinates, metres, which is the scale of its rounding errors.
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

    /// The support function: the largest `dir · p`.
    #[inline]
    pub fn reach(&self, dir: Vec3) -> f64 {
        self.support(dir).dot(dir)
    }

    /// Bounds of the core in its own frame.
    pub fn aabb(&self) -> Aabb {
        let max = Vec3::new(self.reach(Vec3::X), self.reach(Vec3::Y), self.reach(Vec3::Z));
        let min = -Vec3::new(self.reach(-Vec3::X), self.reach(-Vec3::Y), self.reach(-Vec3::Z));
        Aabb { min, max }
    }
}
