//! Containment of one mesh in another.

use elbowroom_spatial::{Pose, Vec3};

use crate::TriMesh;

/// A point of one mesh inside the other (world); the surfaces are known not to touch.
pub(super) fn contained_point(a: &TriMesh, a_in_world: &Pose, b: &TriMesh, b_in_world: &Pose) -> Option<Vec3> {
    point_inside(a, a_in_world, b, b_in_world).or_else(|| point_inside(b, b_in_world, a, a_in_world))
}

/// A point of `inner` inside `outer`.
fn point_inside(outer: &TriMesh, outer_in_world: &Pose, inner: &TriMesh, inner_in_world: &Pose) -> Option<Vec3> {
    if !outer.has_interior() {
        return None;
    }
    let inner_in_outer = outer_in_world.inverse_mul(inner_in_world);
    // The surfaces do not touch, so a connected mesh is inside either as a whole or not at all.
    let bounds = outer.aabb();
    if inner.component_vertices().len() == 1
        && !inner.extremes.iter().all(|&p| bounds.contains(inner_in_outer.transform_point(p)))
    {
        return None;
    }
    let inside = |p: &&Vec3| outer.contains(inner_in_outer.transform_point(**p));
    inner.component_vertices().iter().find(inside).map(|&p| inner_in_world.transform_point(p))
}
