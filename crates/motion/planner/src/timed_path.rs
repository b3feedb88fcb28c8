//! Paths with their motion in time.

use elbowroom_kinematics::JointTrajectory;

use crate::joint_path::JointPath;

/// A path with its time parametrization, at rest at both ends.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedPath {
    /// The path.
    pub path: JointPath,
    /// The motion along the path, from time 0 on.
    pub trajectory: JointTrajectory,
    /// Number of corners at which the motion rests.
    pub stops: usize,
}
