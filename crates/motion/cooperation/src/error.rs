//! Why a virtual robot cannot be made, or does not take a pose.

use elbowroom_robot::GeometryId;
use thiserror::Error;

/// Why a [`VirtualRobot`](crate::VirtualRobot) cannot be made.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CooperationError {
    /// Fewer than two arms, or an arm twice.
    #[error("a virtual robot consists of at least two different robots")]
    Members,
    /// A setting is not usable.
    #[error("a setting is not a positive, finite number")]
    Settings,
    /// The holder, or its grasp, does not exist.
    #[error("the holder has no such grasp")]
    NoSuchGrasp,
    /// A number of limits that is not the number of joints.
    #[error("robot {0} of the virtual robot has not one limit per joint")]
    Limits(usize),
    /// The holder is not where the grasp is.
    #[error("the tool of the holder is {distance_m:.4} m and {angle_rad:.3} rad from its grasp")]
    NotGrasped {
        /// Distance of the tool centre point from the grasp, m.
        distance_m: f64,
        /// Angle between tool and grasp, rad.
        angle_rad: f64,
    },
    /// A hand at the pre-grasp is nearer to the work-piece than the gap: it would never get there.
    #[error(
        "at the pre-grasp of its grasp {grasp}, the hand of robot {member} is nearer to the work-piece than the gap"
    )]
    ShortApproach {
        /// Index of the arm.
        member: usize,
        /// Index of its grasp.
        grasp: usize,
    },
    /// Two parts touch at the start.
    #[error("two parts touch at the start")]
    Touching(GeometryId, GeometryId),
    /// The scene does not have the work-piece, or a robot, or a link.
    #[error("{0}")]
    Scene(String),
}

/// Why a desired pose is not taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum PoseRefusal {
    /// A number is not finite.
    #[error("the desired pose is not finite")]
    NotFinite,
    /// Its time is not after that of the pose before.
    #[error("the time of the desired pose is not after that of the last one")]
    Time,
    /// It is so far away that the work-piece would take more than a day.
    #[error("the desired pose is too far away")]
    Far,
    /// Too many poses wait to be carried out.
    #[error("too many desired poses are not carried out yet")]
    Full,
}
