//! Errors of the avoidance.

use elbowroom_planner::RrtConnectError;
use elbowroom_scene::SceneError;

use crate::LimitProblem;

/// Why a tick has no command (then stop the robot), or why no detour was planned.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AvoidanceError {
    /// A pose or configuration is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The motion of an object is not finite.
    #[error("the motion of `{object}` is not finite: give velocities in m/s and rad/s, 0 where it is at rest")]
    Motion {
        /// Name of the object.
        object: String,
    },
    /// The velocities of another robot are missing or not finite.
    #[error(
        "`{robot}` gives {given} velocities for {joints} joints, or one that is not finite: give qd, 0 where it is at rest"
    )]
    Neighbour {
        /// Name of the robot.
        robot: String,
        /// Number of given velocities.
        given: usize,
        /// Number of joints of the robot.
        joints: usize,
    },
    /// The limits of a joint are invalid.
    #[error("the limits of joint {joint} (from 0): {what}")]
    Limit {
        /// Index of the joint.
        joint: usize,
        /// The problem.
        what: LimitProblem,
    },
    /// The number of limits differs from the number of joints.
    #[error("{given} limits for {joints} joints: give one per independent joint, `JointLimits::of_chain` makes them")]
    Limits {
        /// Number of given limits.
        given: usize,
        /// Number of joints of the robot.
        joints: usize,
    },
    /// A detour cannot start while the robot moves, or after the robot has left the start of the detour.
    #[error(
        "a detour starts at rest where it was planned, and the robot moves: plan when `AvoiderOutput::requests_detour` is true"
    )]
    NotStationary,
    /// No detour was found.
    #[error(transparent)]
    Route(#[from] RrtConnectError),
    /// The duration of a tick is not positive.
    #[error("a tick of {0} s: give the time to the next command, above 0 s")]
    TickDuration(f64),
    /// The reference of the path is invalid.
    #[error(
        "the path gives {given} values for {joints} joints, or one that is not finite: give q and qd, one number per joint"
    )]
    Reference {
        /// Number of given values, the smaller of q and qd.
        given: usize,
        /// Number of joints of the robot.
        joints: usize,
    },
}
