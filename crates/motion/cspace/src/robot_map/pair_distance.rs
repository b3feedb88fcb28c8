//! One piece and one obstacle: tests whether they are proven farther apart than a threshold.

use elbowroom_proximity::advanced::{distance_upper_bound, is_farther_than};
use elbowroom_proximity::{Shape, WarmStart, Workspace, separation_within};
use elbowroom_spatial::Pose;

use super::placed_obstacle::PlacedObstacle;

/// Returns `None` if a piece is certainly farther from an obstacle than `threshold_m`, otherwise an estimate of the
/// distance. Between meshes the cheapest test is first: one pair of triangles that is near enough decides.
pub(super) fn distance_within(
    workspace: &mut Workspace,
    shape: &Shape,
    in_world: &Pose,
    obstacle: &PlacedObstacle,
    threshold_m: f64,
    warm_start: &mut WarmStart,
) -> Option<f64> {
    let (Shape::Mesh(a), Shape::Mesh(b)) = (shape, &obstacle.shape) else {
        let found = separation_within(shape, in_world, &obstacle.shape, &obstacle.in_world, threshold_m);
        return found.filter(|s| s.lower_bound <= threshold_m).map(|s| s.distance);
    };
    let metres = distance_upper_bound(a, in_world, b, &obstacle.in_world, warm_start, workspace);
    if metres <= threshold_m {
        return Some(metres);
    }
    // If the distance is not proven larger, other triangles are near, or one mesh is inside the other.
    (!is_farther_than(a, in_world, b, &obstacle.in_world, threshold_m, workspace)).then_some(threshold_m)
}
