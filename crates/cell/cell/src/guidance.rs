//! What a person who guides a robot has: fixtures, and who guides which robot.

use elbowroom_robot::RobotId;

use crate::{CellFixture, CellOperator};

/// Fixtures and operators of a cell.
#[derive(Debug, Clone, Default)]
pub struct Guidance {
    /// Virtual fixtures, in file order.
    pub fixtures: Vec<CellFixture>,
    /// Operators, in file order; at most one per robot.
    pub operators: Vec<CellOperator>,
}

impl Guidance {
    /// The operator of a robot; `None` for a robot without.
    pub fn operator_of(&self, robot: RobotId) -> Option<&CellOperator> {
        self.operators.iter().find(|operator| operator.robot == robot)
    }
}
