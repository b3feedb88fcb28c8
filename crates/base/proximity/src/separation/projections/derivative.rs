//! Projection onto a core and its derivative.

use elbowroom_spatial::{Rotation, Vec3};

use crate::separation::core::Core;
use crate::triangle::nearest_on_triangle;

/// Nearest point and its derivative: a symmetric matrix, as columns, with eigenvalues in 0..1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Projection {
    pub point: Vec3,
    pub derivative: [Vec3; 3],
}

impl Projection {
    #[inline]
    fn diagonal(point: Vec3, x: f64, y: f64, z: f64) -> Self {
        Self { point, derivative: [Vec3::X * x, Vec3::Y * y, Vec3::Z * z] }
    }
}

#[inline]
fn free(inside: bool) -> f64 {
    if inside { 1.0 } else { 0.0 }
}

impl Core<'_> {
    /// True if [`Core::project`] is a closed form.
    #[inline]
    pub fn has_closed_projection(&self) -> bool {
        !matches!(self, Self::Points(_) | Self::Hull(_))
    }

    /// The point of the core nearest to `p`, local frame.
    #[inline]
    pub fn project(&self, p: Vec3) -> Projection {
        match self {
            Self::Point => Projection::diagonal(Vec3::ZERO, 0.0, 0.0, 0.0),
            Self::Segment(h) => Projection::diagonal(Vec3::Z * p.z.max(-h).min(*h), 0.0, 0.0, free(p.z.abs() < *h)),
            Self::Cuboid(c) => {
                let (h, m) = (c.half_extents, p.abs());
                Projection::diagonal(c.nearest(p), free(m.x < h.x), free(m.y < h.y), free(m.z < h.z))
            }
            Self::Cylinder(c) => {
                let point = c.nearest(p);
                let along = free(p.z.abs() < c.half_length);
                let rho2 = p.x * p.x + p.y * p.y;
                if rho2 <= c.radius * c.radius {
                    return Projection::diagonal(point, 1.0, 1.0, along);
                }
                // On the rim only rotation about the axis remains.
                let k = c.radius / rho2.sqrt() / rho2;
                let xy = -p.x * p.y * k;
                let derivative =
                    [Vec3::new(p.y * p.y * k, xy, 0.0), Vec3::new(xy, p.x * p.x * k, 0.0), Vec3::Z * along];
                Projection { point, derivative }
            }
            Self::Triangle(t) => on_triangle(nearest_on_triangle(p, *t), *t),
            Self::Hull(h) => match h.nearest_with_face(p) {
                (point, Some(face)) => on_triangle(point, h.corners(face)),
                (point, None) => Projection::diagonal(point, 1.0, 1.0, 1.0),
            },
            Self::Points(_) => Projection::diagonal(self.middle(), 0.0, 0.0, 0.0),
        }
    }
}

/// The derivative of the projection onto the corner, edge or face that contains `q`.
fn on_triangle(q: Vec3, [a, b, c]: [Vec3; 3]) -> Projection {
    let n = (b - a).cross(c - a);
    let area = n.length_squared();
    let weight = |u: Vec3, v: Vec3| n.dot((u - q).cross(v - q));
    let inside = [weight(b, c), weight(c, a), weight(a, b)].map(|w| w > 1e-12 * area);
    let line = |d: Vec3| {
        let k = 1.0 / d.length_squared();
        [d * (d.x * k), d * (d.y * k), d * (d.z * k)]
    };
    let none = [Vec3::ZERO; 3];
    let derivative = match inside {
        [true, true, true] => {
            let across = line(n);
            [Vec3::X - across[0], Vec3::Y - across[1], Vec3::Z - across[2]]
        }
        [true, true, false] => line(b - a),
        [false, true, true] => line(c - b),
        [true, false, true] => line(a - c),
        _ => none,
    };
    Projection { point: q, derivative }
}

/// The Newton step to the fixed point of alternating projection. `moved` is the step of one alternating projection;
/// the derivative of `onto_a` is in the frame of a.
#[inline]
pub(super) fn newton_step(a_in_b: Rotation, onto_a: &Projection, onto_b: &Projection, moved: Vec3, trust: f64) -> Vec3 {
    let through_a = |v: Vec3| {
        let v = a_in_b.inverse_rotate(v);
        let m = &onto_a.derivative;
        a_in_b * (m[0] * v.x + m[1] * v.y + m[2] * v.z)
    };
    let n = &onto_b.derivative;
    let x = Vec3::X - through_a(n[0]) * trust;
    let y = Vec3::Y - through_a(n[1]) * trust;
    let z = Vec3::Z - through_a(n[2]) * trust;
    let (yz, zx, xy) = (y.cross(z), z.cross(x), x.cross(y));
    let determinant = x.dot(yz);
    let step = Vec3::new(moved.dot(yz), moved.dot(zx), moved.dot(xy)) / determinant;
    if step.is_finite() { step } else { moved }
}
