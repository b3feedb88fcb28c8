//! The empty slab between two shapes: a motion along the gap does not shrink it.

use elbowroom_spatial::{Pose, Vec3};

use crate::separation::rounding;
use crate::shape::hull::farthest;
use crate::{Separation, Shape};

/// Largest number of vertices of a mesh that is used itself. A larger mesh is replaced by its box: its exact extent
/// would cost more than it saves.
const MAX_VERTICES: usize = 20_000;

/// A slab with one shape on each side.
#[derive(Debug, Clone, Copy)]
pub(super) struct SeparatingSlab {
    /// Unit vector in the world, from B to A.
    pub normal: Vec3,
    /// Proven thickness, metres, above 0.
    pub thickness: f64,
}

/// The slab perpendicular to the witness points; `None` if none is proven.
pub(super) fn separating_slab(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    near: &Separation,
) -> Option<SeparatingSlab> {
    let normal = match (a, b) {
        (Shape::HalfSpace(_), Shape::HalfSpace(_)) => return None,
        (_, Shape::HalfSpace(_)) => b_in_world.rotation.z_axis(),
        (Shape::HalfSpace(_), _) => -a_in_world.rotation.z_axis(),
        _ => (near.on_a - near.on_b).try_normalize()?,
    };
    let (low, scale_a) = reach(a, a_in_world, -normal);
    let (high, scale_b) = reach(b, b_in_world, normal);
    let thickness = -low - high - 8.0 * rounding(scale_a + scale_b);
    (thickness > 0.0).then_some(SeparatingSlab { normal, thickness })
}

/// Extent along `direction` (world), and the scale of its rounding. For a half-space, `direction` is its normal.
fn reach(shape: &Shape, in_world: &Pose, direction: Vec3) -> (f64, f64) {
    let local = in_world.inverse_transform_vector(direction);
    let point = match shape {
        Shape::Mesh(m) if m.vertices().len() <= MAX_VERTICES => farthest(m.vertices(), local),
        Shape::Mesh(m) => {
            let toward = |low: f64, high: f64, d: f64| if d < 0.0 { low } else { high };
            let (low, high) = (m.aabb().min, m.aabb().max);
            Vec3::new(toward(low.x, high.x, local.x), toward(low.y, high.y, local.y), toward(low.z, high.z, local.z))
        }
        _ => shape.support(local),
    };
    (in_world.transform_point(point).dot(direction), point.length() + in_world.translation.length())
}
