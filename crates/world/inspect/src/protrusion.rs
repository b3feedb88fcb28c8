//! How far boxes protrude from the solids that they enclose.

use std::collections::BinaryHeap;

use elbowroom_proximity::{Shape, project_point};
use elbowroom_spatial::{Obb, Pose, Vec3};

/// Accuracy of the bound, as a fraction of the distance.
const FRACTION: f64 = 0.02;
/// Accuracy of a small bound, m.
const LEAST_M: f64 = 2e-5;
/// Rounding of a box that fits its solid, m.
const ROUNDING_M: f64 = 1e-12;
/// Number of points that are measured at most. After that the bound is looser, but still a bound.
const BUDGET: usize = 50_000;

/// A part of a box, ordered by its bound.
#[derive(Debug, PartialEq)]
struct Part {
    /// Bound (m) on the distance of every point of the part.
    bound: f64,
    centre: Vec3,
    half_extents: Vec3,
    obb: usize,
}

impl Eq for Part {}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Part {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.bound.total_cmp(&other.bound).then(other.obb.cmp(&self.obb))
    }
}

/// Upper bound (m) on the distance of any point of the boxes from the nearest solid, 2 % or 0.02 mm too large at most
/// unless the search becomes long. Boxes and solids are in one frame.
///
/// Branch and bound: the distance of two points differs from that of the solids at most by the distance of the points.
pub(crate) fn bound(boxes: &[Obb], solids: &[(Shape, Pose)]) -> f64 {
    let distance = |p: Vec3| {
        let each = solids.iter().map(|(shape, pose)| project_point(shape, pose, p).signed_distance);
        // Negative inside, so that parts inside a solid need no division.
        each.fold(f64::INFINITY, f64::min)
    };
    let mut reached = boxes.iter().flat_map(Obb::corners).map(distance).fold(0.0, f64::max);
    let mut measured = 8 * boxes.len();
    // A convex solid that contains all corners contains the box.
    let is_inside = |b: &Obb| {
        let holds = |(shape, pose): &(Shape, Pose)| {
            !matches!(shape, Shape::Mesh(_))
                && b.corners().iter().all(|p| project_point(shape, pose, *p).signed_distance <= ROUNDING_M)
        };
        solids.iter().any(holds)
    };
    let mut parts = BinaryHeap::new();
    let measure = |obb: usize, centre: Vec3, half_extents: Vec3, parts: &mut BinaryHeap<Part>| {
        let at_centre = distance(boxes[obb].pose.transform_point(centre));
        parts.push(Part { bound: at_centre + half_extents.length(), centre, half_extents, obb });
        at_centre
    };
    for (obb, b) in boxes.iter().enumerate().filter(|(_, b)| !is_inside(b)) {
        reached = measure(obb, Vec3::ZERO, b.half_extents, &mut parts).max(reached);
    }
    while let Some(part) = parts.pop() {
        if part.bound <= reached + LEAST_M.max(FRACTION * reached) || measured >= BUDGET {
            return part.bound.max(reached);
        }
        let half = part.half_extents * 0.5;
        for corner in (Obb { pose: Pose::from_translation(part.centre), half_extents: half }).corners() {
            reached = measure(part.obb, corner, half, &mut parts).max(reached);
        }
        measured += 8;
    }
    reached
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use elbowroom_proximity::{Cuboid, Sphere, TriMesh, tessellate::tessellate};

    use super::*;

    fn cube(half: f64, at: Vec3) -> Obb {
        Obb { pose: Pose::from_translation(at), half_extents: Vec3::splat(half) }
    }

    fn within(found: f64, exact: f64) {
        assert!(found >= exact - 1e-12 && found <= exact * 1.021 + 2.1e-5, "{found} for {exact}");
    }

    #[test]
    fn corners_around_a_ball_and_gaps_between_solids_are_found() {
        let ball = (Shape::Sphere(Sphere { radius: 1.0 }), Pose::IDENTITY);
        within(bound(&[cube(1.0, Vec3::ZERO)], std::slice::from_ref(&ball)), 3.0_f64.sqrt() - 1.0);
        // The farthest point is in the middle of the box, not at a corner.
        let side = |x: f64| {
            let shape = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.1, 1.0, 1.0) });
            (shape, Pose::from_translation(Vec3::X * x))
        };
        within(
            bound(&[Obb { half_extents: Vec3::new(1.1, 0.2, 0.2), ..cube(1.0, Vec3::ZERO) }], &[side(-1.0), side(1.0)]),
            0.9,
        );
        // A box that fits, and no box.
        let exact = (Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.3) }), Pose::IDENTITY);
        within(bound(&[cube(0.3, Vec3::ZERO)], std::slice::from_ref(&exact)), 0.0);
        assert_eq!(bound(&[], &[exact]), 0.0);
    }

    #[test]
    fn the_inside_of_a_closed_mesh_does_not_protrude() {
        let (vertices, triangles) = tessellate(&Shape::Sphere(Sphere { radius: 1.0 }), 1e-3);
        let mesh = Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()));
        let inside = bound(&[cube(0.5, Vec3::ZERO)], &[(mesh.clone(), Pose::IDENTITY)]);
        assert!(inside <= 2e-5, "{inside}");
        let around = bound(&[cube(1.0, Vec3::ZERO)], &[(mesh, Pose::IDENTITY)]);
        assert!(around > 0.73 && around < 0.75, "{around}");
    }
}
