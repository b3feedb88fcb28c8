//! The order in which a pair of shapes is computed, which is independent of the order of the arguments.

use std::cmp::Ordering;

use elbowroom_spatial::{Pose, Vec3};

use crate::Shape;

/// Rank of a shape: simple shapes come first, so that each pair has one method.
#[inline]
fn rank(s: &Shape) -> u8 {
    match s {
        Shape::Sphere(_) => 0,
        Shape::Capsule(_) => 1,
        Shape::Cylinder(_) => 2,
        Shape::Cuboid(_) => 3,
        Shape::Hull(_) => 4,
        Shape::Mesh(_) => 5,
        Shape::HalfSpace(_) => 6,
    }
}

/// True if `a` is computed as the first shape, so that both orders of the arguments give the same answer.
#[inline]
pub(super) fn comes_first(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> bool {
    let (of_a, of_b) = (rank(a), rank(b));
    // Queries on two meshes are symmetric by themselves.
    if of_a != of_b || matches!(a, Shape::Mesh(_)) {
        return of_a <= of_b;
    }
    let (p, q) = (a_in_world.translation, b_in_world.translation);
    if p.x == q.x { comes_first_by_pose_and_size(a, a_in_world, b, b_in_world) } else { p.x < q.x }
}

#[cold]
fn comes_first_by_pose_and_size(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> bool {
    let size = |s: &Shape| {
        let reach = |d| s.support(d).dot(d);
        [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z].map(reach)
    };
    let by_pose = a_in_world.to_rows().partial_cmp(&b_in_world.to_rows());
    let order = by_pose.filter(|o| o.is_ne()).or_else(|| size(a).partial_cmp(&size(b)));
    !order.is_some_and(Ordering::is_gt)
}
