//! The difference of two poses.

use elbowroom_spatial::Pose;

/// Difference (m, rad) below which poses are equal.
pub(super) const SAME_POSE: f64 = 1e-9;

/// The larger of the angle (rad) and the distance (m) between two poses.
pub(super) fn pose_difference(a: &Pose, b: &Pose) -> f64 {
    (a.rotation.inverse() * b.rotation).angle().max(a.translation.distance(b.translation))
}
