//! What a person who guides a robot has: fixtures, and who guides which robot.

use elbowroom_robot::RobotId;

use crate::{CellFixture, CellForce, CellGuide, CellOperator};

/// Fixtures, operators and forces of a cell.
#[derive(Debug, Clone, Default)]
pub struct Guidance {
    /// Virtual fixtures that protect, in file order.
    pub fixtures: Vec<CellFixture>,
    /// Virtual fixtures that guide, in file order; at most one is on for a tool.
    pub guides: Vec<CellGuide>,
    /// Operators, in file order; at most one per robot.
    pub operators: Vec<CellOperator>,
    /// Forces, in file order.
    pub forces: Vec<CellForce>,
}

impl Guidance {
    /// The operator of a robot; `None` for a robot without.
    pub fn operator_of(&self, robot: RobotId) -> Option<&CellOperator> {
        self.operators.iter().find(|operator| operator.robot == robot)
    }
}
