//! Simultaneous descent of both trees, on parry's public `Bvh::leaf_pairs`: code that an experienced user of parry writes.

use std::cell::Cell;

use parry3d_f64::math::{Matrix, Pose, Vector};
use parry3d_f64::partitioning::BvhNode;
use parry3d_f64::query::{ClosestPoints, DefaultQueryDispatcher, PointQuery, QueryDispatcher};
use parry3d_f64::shape::TriMesh;

/// Boxes of the second tree, rotated into the first mesh's frame.
pub struct Turned {
    rotation: Matrix,
    magnitudes: [Vector; 3],
    translation: Vector,
}

impl Turned {
    pub fn new(pose: &Pose) -> Self {
        let rotation = Matrix::from_quat(pose.rotation);
        let magnitudes = [rotation.x_axis.abs(), rotation.y_axis.abs(), rotation.z_axis.abs()];
        Self { rotation, magnitudes, translation: pose.translation }
    }

    /// Centre and half extents of the box around the rotated box.
    pub fn around(&self, low: Vector, high: Vector) -> (Vector, Vector) {
        let (middle, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let [x, y, z] = self.magnitudes;
        (self.rotation * middle + self.translation, x * half.x + y * half.y + z * half.z)
    }

    /// Gap between the boxes of two nodes along each axis; negative if they overlap.
    fn gaps(&self, a: &BvhNode, b: &BvhNode) -> Vector {
        let (middle, half) = self.around(b.mins(), b.maxs());
        (a.mins() - (middle + half)).max((middle - half) - a.maxs())
    }
}

/// Whether any pair of triangles is within `margin`.
pub fn close(a: &TriMesh, b: &TriMesh, b_in_a: &Pose, margin: f64) -> bool {
    let turned = Turned::new(b_in_a);
    let mut pairs = a.bvh().leaf_pairs(b.bvh(), |x, y| turned.gaps(x, y).max_element() <= margin);
    pairs.any(|(i, j)| {
        let (x, y) = (a.triangle(i), b.triangle(j));
        if margin > 0.0 {
            let found = DefaultQueryDispatcher.closest_points(b_in_a, &x, &y, margin);
            found.is_ok_and(|found| found != ClosestPoints::Disjoint)
        } else {
            DefaultQueryDispatcher.intersection_test(b_in_a, &x, &y).is_ok_and(|found| found.intersecting)
        }
    })
}

/// Distance of the meshes, or `limit` if the distance is larger. The smallest distance found so far prunes the descent.
pub fn distance(a: &TriMesh, b: &TriMesh, b_in_a: &Pose, limit: f64) -> f64 {
    let turned = Turned::new(b_in_a);
    let best = Cell::new(limit.min(beginning(a, b, b_in_a)));
    let near =
        |x: &BvhNode, y: &BvhNode| turned.gaps(x, y).max(Vector::splat(0.0)).length_squared() < best.get() * best.get();
    for (i, j) in a.bvh().leaf_pairs(b.bvh(), near) {
        let found = DefaultQueryDispatcher.distance(b_in_a, &a.triangle(i), &b.triangle(j));
        best.set(best.get().min(found.map_or(f64::INFINITY, |found| found.distance)));
        if best.get() <= 0.0 {
            return 0.0;
        }
    }
    best.get()
}

/// Upper bound of the distance: a point projected from one surface to the other and back.
fn beginning(a: &TriMesh, b: &TriMesh, b_in_a: &Pose) -> f64 {
    let a_in_b = b_in_a.inverse();
    let mut on_a = a.local_aabb().center();
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let on_b = b.project_local_point(a_in_b * on_a, false).point;
        on_a = a.project_local_point(*b_in_a * on_b, false).point;
        best = best.min((*b_in_a * on_b - on_a).length());
    }
    best
}
