//! Virtual fixtures of a cell.

use std::sync::{Arc, OnceLock};

use elbowroom_proximity::TriMesh;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_shared_control::{Guide, ProtectedSurface, Shield, ShieldSettings, ShieldTarget};

/// A fixture that protects: `[fixture.NAME]` without `guide`.
#[derive(Debug, Clone)]
pub struct CellFixture {
    /// Its name.
    pub name: String,
    /// Line of its table.
    pub line: usize,
    /// The protected object.
    pub protects: ObjectId,
    /// Its surface.
    pub shield: ShieldSource,
    /// The tool that it is for; `None` if the file names none.
    pub tool: Option<FixtureTool>,
    /// Whether it is on at the start.
    pub active: bool,
    /// The shield, once it was made.
    pub(crate) made: OnceLock<Shield>,
    /// The shield in the world, once a tool was to glide along it.
    pub(crate) placed: OnceLock<ProtectedSurface>,
}

/// A tool of a robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FixtureTool {
    /// The robot.
    pub robot: RobotId,
    /// Index of a named tool; `None` for the only one.
    pub named: Option<usize>,
}

/// Where the surface of a shield comes from.
#[derive(Debug, Clone)]
pub enum ShieldSource {
    /// It is generated around the object.
    Generated {
        /// What the tool is to reach, in the frame of the object.
        target: ShieldTarget,
        /// Dimensions of the shield.
        settings: ShieldSettings,
    },
    /// A mesh, in the frame of the object.
    Mesh(Arc<TriMesh>),
}

/// A fixture that guides: `[fixture.NAME]` with `guide`.
#[derive(Debug, Clone)]
pub struct CellGuide {
    /// Its name.
    pub name: String,
    /// Line of its table.
    pub line: usize,
    /// Where the hand is kept in the world, or where the shaft of the tool enters.
    pub guide: Guide,
    /// The tool that it is for.
    pub tool: FixtureTool,
    /// Whether it is on at the start.
    pub active: bool,
}
