//! What a robot carries on its flange.

use elbowroom_robot::Collider;

use crate::CellTool;

/// Payload of a robot: a tool and a load, or named tools.
#[derive(Debug, Clone, Default)]
pub struct Payload {
    /// The tool's collider, in the flange link.
    pub tool: Option<Collider>,
    /// The load's collider, in the flange link.
    pub load: Option<Collider>,
    /// The named tools, in file order. A robot with named tools has no `tool` and no `load`; the colliders of mounted
    /// tools are in the links of the robot's model.
    pub tools: Vec<CellTool>,
}

impl Payload {
    /// Colliders of tool and load, in the flange link.
    pub fn colliders(&self) -> impl Iterator<Item = &Collider> {
        [&self.tool, &self.load].into_iter().flatten()
    }
}
