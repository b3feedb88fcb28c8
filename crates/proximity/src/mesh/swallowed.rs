//! One mesh wholly inside another.

use elbowroom_spatial::{Pose, Vec3};

use crate::TriMesh;

/// A point of one mesh that lies inside the other (world), where the surfaces are known not to touch.
pub(super) fn swallowed(a: &TriMesh, a_in_world: &Pose, b: &TriMesh, b_in_world: &Pose) -> Option<Vec3> {
    inside(a, a_in_world, b, b_in_world).or_else(|| inside(b, b_in_world, a, a_in_world))
}

/// A point of `small` inside `large`.
fn inside(large: &TriMesh, large_in_world: &Pose, small: &TriMesh, small_in_world: &Pose) -> Option<Vec3> {
    if !large.has_inside() {
        return None;
    }
    let small_in_large = large_in_world.inverse_mul(small_in_world);
    // Apart surfaces: a connected mesh is inside as a whole or not at all.
    let room = large.aabb();
    if small.parts.len() == 1 && !small.extremes.iter().all(|&p| room.contains(small_in_large.transform_point(p))) {
        return None;
    }
    let found = small.parts.iter().find(|&&p| large.contains(small_in_large.transform_point(p)));
    found.map(|&p| small_in_world.transform_point(p))
}
