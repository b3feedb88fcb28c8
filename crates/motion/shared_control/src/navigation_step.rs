//! The result of one step of a navigator.

use elbowroom_spatial::{Pose, Vec3};

/// What one step did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NavigationStep {
    /// Pose of the tool after the step, in the world.
    pub tool_in_world: Pose,
    /// Velocity of the tool point during the step, m/s, world axes.
    pub velocity: Vec3,
    /// The distance between tool and surfaces at the start of the step, metres; `None` if no surface is in the range in
    /// which surfaces influence the motion, or the tool stands because of its input.
    pub gap_m: Option<f64>,
    /// Number of surface points, up to three, that constrained the velocity or keep the tool from the desired point.
    pub active_rows: usize,
    /// What kept the tool from following the desired pose as fast as the settings allow; `None` if it followed.
    pub limit: Option<Limit>,
}

/// What kept the tool from following.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Limit {
    /// A surface: the tool glides, or stands where it cannot come nearer.
    Surface,
    /// The proof of the step ended before its end.
    Proof,
    /// The point of entry: the shaft is not there yet, or cannot turn about it as the motion of the tip demands.
    Entry,
    /// The desired pose has a number that is not finite: the tool stands.
    PoseNotFinite,
    /// The duration of the step is not positive or above [`NavigatorSettings::longest_step_s`]: the tool stands.
    ///
    /// [`NavigatorSettings::longest_step_s`]: crate::NavigatorSettings::longest_step_s
    StepDuration,
    /// The distance to a surface is unknown: the tool stands.
    DistanceUnknown,
}
