//! Points of a shape whose speeds bound the speed of the whole shape.

use elbowroom_spatial::Vec3;

use crate::Shape;

/// Points (local frame) whose convex hull encloses the shape without its rounding radius.
///
/// The radius is excluded: the distance to a sphere is the distance to its centre minus a constant. So it changes no
/// faster than the centre moves, however fast the sphere rotates.
#[derive(Debug, Clone, Copy)]
pub(super) struct EnclosingPoints {
    points: [Vec3; 8],
    used: usize,
}

impl EnclosingPoints {
    /// The points of a shape; `None` for a half-space: the speed of its points is unbounded as soon as it rotates.
    pub fn of(shape: &Shape) -> Option<Self> {
        let corners = |low: Vec3, high: Vec3| {
            let pick = |k: usize, bit: usize, l: f64, h: f64| if k & bit == 0 { l } else { h };
            Self {
                points: std::array::from_fn(|k| {
                    Vec3::new(pick(k, 1, low.x, high.x), pick(k, 2, low.y, high.y), pick(k, 4, low.z, high.z))
                }),
                used: 8,
            }
        };
        Some(match shape {
            Shape::Sphere(_) => Self::few(&[Vec3::ZERO]),
            Shape::Capsule(c) => Self::few(&[Vec3::Z * c.half_length, Vec3::Z * -c.half_length]),
            Shape::Cylinder(c) => {
                let half = Vec3::new(c.radius, c.radius, c.half_length);
                corners(-half, half)
            }
            Shape::Cuboid(c) => corners(-c.half_extents, c.half_extents),
            Shape::Hull(h) if h.vertices().len() <= 8 => Self::few(h.vertices()),
            Shape::Hull(h) => corners(h.aabb().min, h.aabb().max),
            Shape::Mesh(m) if m.vertices().len() <= 8 => Self::few(m.vertices()),
            Shape::Mesh(m) => corners(m.aabb().min, m.aabb().max),
            Shape::HalfSpace(_) => return None,
        })
    }

    /// Creates a set of up to eight points.
    pub fn few(points: &[Vec3]) -> Self {
        let used = points.len().min(8);
        Self { points: std::array::from_fn(|k| points.get(k).copied().unwrap_or_default()), used }
    }

    pub fn points(&self) -> &[Vec3] {
        &self.points[..self.used]
    }

    /// Largest distance from the frame's origin, metres.
    pub fn radius(&self) -> f64 {
        self.points().iter().fold(0.0, |r: f64, p| r.max(p.length()))
    }
}
