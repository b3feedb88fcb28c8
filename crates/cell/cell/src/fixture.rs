//! Virtual fixtures of a cell.

use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_shared_control::{ShieldSettings, ShieldTarget};

/// A fixture: `[fixture.NAME]`.
#[derive(Debug, Clone)]
pub struct CellFixture {
    /// Its name.
    pub name: String,
    /// Line of its table.
    pub line: usize,
    /// The protected object.
    pub protects: ObjectId,
    /// What the tool is to reach, in the frame of the object.
    pub target: ShieldTarget,
    /// Dimensions of the shield.
    pub settings: ShieldSettings,
    /// The tool that it is for; `None` if the file names none.
    pub tool: Option<FixtureTool>,
    /// Whether it is on at the start.
    pub active: bool,
}

/// A tool of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FixtureTool {
    /// The robot.
    pub robot: RobotId,
    /// Index of a named tool; `None` for the only one.
    pub named: Option<usize>,
}
