//! What a tick refuses.

use elbowroom_scene::SceneError;

/// Why a tick commanded nothing. The robot is to be stopped then.
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
