//! The goal of a damped least-squares search: equations on the pose of a tip.

use elbowroom_spatial::{Pose, Vec3};

/// `R` equations on the pose of a tip in the root.
pub trait Goal<const R: usize> {
    /// What [`Goal::jacobian_column`] needs from the pose at which it is evaluated.
    type Linearization: Copy;

    /// Computes the linearization, once per Jacobian.
    fn linearize(&self, tip_in_root: &Pose) -> Self::Linearization;

    /// The error vector, with metres scaled to be comparable with radians. The search minimizes its square.
    fn error(&self, tip_in_root: &Pose) -> [f64; R];

    /// Decrease of the error per unit of a motion of the tip: `linear` (m) and `angular` (rad), in the root.
    fn jacobian_column(&self, at: &Self::Linearization, linear: Vec3, angular: Vec3) -> [f64; R];

    /// True if the error is within the tolerances.
    fn is_met(&self, error: &[f64; R]) -> bool;
}
