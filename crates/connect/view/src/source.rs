//! Source of the shown status, and the commands of a page.

use elbowroom_kinematics::inverse::IkError;
use elbowroom_robot::RobotId;
use elbowroom_status::{CellStatus, EventStatus};
use serde::Deserialize;

/// A command of a page.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(tag = "type", rename_all = "lowercase", deny_unknown_fields)]
pub(crate) enum Command {
    /// Sets joint values, rad or m.
    Jog {
        /// Index of the robot in the cell.
        robot: usize,
        /// One value per joint.
        q: Vec<f64>,
    },
    /// Moves the tool centre point in the world.
    Tcp {
        /// Index of the robot in the cell.
        robot: usize,
        /// Target position, m.
        position_m: [f64; 3],
        /// Target rotation, `[x, y, z, w]`; `None` keeps the present one.
        #[serde(default)]
        quaternion_xyzw: Option<[f64; 4]>,
    },
    /// Moves all robots to their start.
    Home {},
}

impl Command {
    /// Whether it makes an earlier command pointless.
    pub(crate) fn replaces(&self, other: &Self) -> bool {
        match (self, other) {
            (
                Self::Jog { robot: a, .. } | Self::Tcp { robot: a, .. },
                Self::Jog { robot: b, .. } | Self::Tcp { robot: b, .. },
            ) => a == b,
            (Self::Home {}, _) => true,
            _ => false,
        }
    }
}

/// Why a command is not carried out.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CommandRefusal {
    /// The page cannot move the robots.
    #[error("this page shows a running cell: its robots are moved by their controllers")]
    RunningCell,
    /// The cell has no robot with this index.
    #[error("there is no robot {}", .0.0)]
    NoRobot(RobotId),
    /// The number of values differs from the number of joints.
    #[error("`{robot}` has {joints} joints, not {values}")]
    JointCount { robot: String, joints: usize, values: usize },
    /// A value beyond the limits, in the unit of the page: mm or degrees.
    #[error("joint `{joint}` may be at {lower:.2} to {upper:.2} {unit}, not at {value:.2}")]
    Limits { joint: String, unit: &'static str, lower: f64, upper: f64, value: f64 },
    /// A number of the pose is not finite.
    #[error("the pose is not finite")]
    Pose,
    /// Inverse kinematics finds no joint values.
    #[error(transparent)]
    Ik(#[from] IkError),
}

/// Source of the shown status.
pub(crate) trait ViewSource {
    /// Mode of the pages: `watch` or `jog`.
    fn mode(&self) -> &'static str;

    /// Carries out a command.
    ///
    /// # Errors
    /// [`CommandRefusal`], for the person at the page.
    fn command(&mut self, command: Command) -> Result<(), CommandRefusal>;

    /// Returns the status after commands, with the events; `None` if statuses come from elsewhere.
    fn status(&mut self) -> Option<(CellStatus, Vec<EventStatus>)>;
}

/// A running cell: its statuses come through the feed, and pages cannot change it.
#[derive(Debug)]
pub(crate) struct RunningCell;

impl ViewSource for RunningCell {
    fn mode(&self) -> &'static str {
        "watch"
    }

    fn command(&mut self, _: Command) -> Result<(), CommandRefusal> {
        Err(CommandRefusal::RunningCell)
    }

    fn status(&mut self) -> Option<(CellStatus, Vec<EventStatus>)> {
        None
    }
}
