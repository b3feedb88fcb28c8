//! The empty slab between two shapes: what lets a motion along the gap go by in one step.

use elbowroom_spatial::{Pose, Vec3};

use crate::separation::core::rounding;
use crate::shape::hull::farthest;
use crate::{Separation, Shape};

/// A mesh of more vertices is seen as its box: its own extent would cost more than it saves.
const FEW: usize = 20_000;

/// Unit normal (world, from B to A) and thickness of a slab with A on one side and B on the other; proven, metres.
/// `None` where nothing is known or the slab is empty.
pub(super) fn between(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    near: &Separation,
) -> Option<(Vec3, f64)> {
    let normal = match (a, b) {
        (Shape::HalfSpace(_), Shape::HalfSpace(_)) => return None,
        (_, Shape::HalfSpace(_)) => b_in_world.rotation.z_axis(),
        (Shape::HalfSpace(_), _) => -a_in_world.rotation.z_axis(),
        _ => (near.on_a - near.on_b).try_normalize()?,
    };
    let (low, scale_a) = reach(a, a_in_world, -normal);
    let (high, scale_b) = reach(b, b_in_world, normal);
    let thickness = -low - high - 8.0 * rounding(scale_a + scale_b);
    (thickness > 0.0).then_some((normal, thickness))
}

/// Extent along `direction` (world), and the scale of the numbers it was found from. A half-space is asked along its
/// normal only.
fn reach(shape: &Shape, in_world: &Pose, direction: Vec3) -> (f64, f64) {
    let local = in_world.inverse_transform_vector(direction);
    let point = match shape {
        Shape::Mesh(m) if m.vertices().len() <= FEW => farthest(m.vertices(), local),
        Shape::Mesh(m) => {
            let toward = |low: f64, high: f64, d: f64| if d < 0.0 { low } else { high };
            let (low, high) = (m.aabb().min, m.aabb().max);
            Vec3::new(toward(low.x, high.x, local.x), toward(low.y, high.y, local.y), toward(low.z, high.z, local.z))
        }
        _ => shape.support(local),
    };
    (in_world.transform_point(point).dot(direction), point.length() + in_world.translation.length())
}
