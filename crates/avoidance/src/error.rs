//! What a tick refuses.

use elbowroom_planner::RouteError;
use elbowroom_scene::SceneError;

/// Why a tick commanded nothing (the robot is to be stopped then), or no way is gone.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AvoidanceError {
    /// Something cannot be where it is said to be.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A velocity that is none.
    #[error("the motion of `{object}` is not finite: give velocities in m/s and rad/s, 0 where it stands")]
    Motion {
        /// Name of the object.
        object: String,
    },
    /// Another robot does not say how it moves.
    #[error(
        "`{robot}` gives {given} velocities for {joints} joints, or one that is not finite: give qd, 0 where it stands"
    )]
    Neighbour {
        /// Its name.
        robot: String,
        /// Numbers given.
        given: usize,
        /// Joints that it has.
        joints: usize,
    },
    /// Limits that no joint can have.
    #[error("the limits of joint {joint} (from 0): {what}")]
    Limit {
        /// Number of the joint.
        joint: usize,
        /// What is wrong, and what to write instead.
        what: &'static str,
    },
    /// Not one per joint.
    #[error("{given} limits for {joints} joints: give one per independent joint, `JointLimit::of` makes them")]
    Limits {
        /// Entries given.
        given: usize,
        /// Joints of the robot.
        joints: usize,
    },
    /// A way is asked for while the robot moves.
    #[error("a way begins where the robot stands, and it moves: plan when `Advice::wants_way` says so")]
    Underway,
    /// No way was found.
    #[error(transparent)]
    Route(#[from] RouteError),
    /// No time to move in.
    #[error("a tick of {0} s: give the time to the next command, above 0 s")]
    Period(f64),
    /// The path asks for what cannot be.
    #[error(
        "the path gives {given} values for {joints} joints, or one that is not finite: give q and qd, one number per joint"
    )]
    Reference {
        /// Numbers given, the smaller of q and qd.
        given: usize,
        /// Joints of the robot.
        joints: usize,
    },
}
