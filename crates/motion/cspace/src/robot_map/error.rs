//! Errors of robot maps.

use super::settings::MAX_JOINTS;
use crate::GridAxisError;

/// Why a map of a robot cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RobotMapError {
    /// The map has no joints or too many.
    #[error("a map has 1 to {MAX_JOINTS} joints, not {0}: name fewer of them")]
    Count(usize),
    /// The robot does not have a joint, or a joint is named twice.
    #[error("joint {joint} of {dof} is no axis, or one for the second time: name each joint once, counted from 0")]
    Joint {
        /// The given index.
        joint: usize,
        /// Number of joints of the robot.
        dof: usize,
    },
    /// An axis cannot be divided into cells.
    #[error(transparent)]
    Axis(#[from] GridAxisError),
    /// The fixed values of the remaining joints do not fit the robot.
    #[error("the other joints are held at {given} values, the robot has {dof}: give one finite number per joint")]
    FixedValues {
        /// Number of given values.
        given: usize,
        /// Number of joints of the robot.
        dof: usize,
    },
    /// A solid or the base has a pose or a size that is not finite.
    #[error("{0} has a place or a size that is NaN, infinite or beyond 1e5 m: give metres")]
    InvalidPlacement(String),
    /// The links of the map are not all carried by one joint, or its axis also moves another joint.
    #[error("the links do not all hang on one joint of the map that moves alone: use RobotMapBuilder")]
    NoCommonJoint,
    /// The slack of covers is not a valid length.
    #[error("the slack of covers is {0} m: give a finite length above 0, such as 0.004")]
    Slack(f64),
    /// The clearance is not a valid length.
    #[error("the clearance of a map is {0} m: give a finite length, 0 or more, such as 0.02")]
    Clearance(f64),
    /// The map would exceed the memory limit.
    #[error("the map needs more than {mib} MiB: make the steps larger, or allow more memory")]
    Memory {
        /// Memory limit, MiB.
        mib: usize,
    },
}
