//! What a person who guides a robot has: fixtures, and who guides which robot.

use elbowroom_robot::RobotId;

use crate::{CellFixture, CellForce, CellGuide, CellOperator, CellVirtualRobot};

/// Fixtures, operators, forces and virtual robots of a cell.
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
    /// Robots that act as one, in file order; a robot is a member of at most one.
    pub virtual_robots: Vec<CellVirtualRobot>,
}

impl Guidance {
    /// The operator of a robot; `None` for a robot without.
    pub fn operator_of(&self, robot: RobotId) -> Option<&CellOperator> {
        self.operators.iter().find(|operator| operator.robot == robot)
    }

    /// The virtual robot that a robot is a member of.
    pub fn virtual_robot_of(&self, robot: RobotId) -> Option<&CellVirtualRobot> {
        self.virtual_robots.iter().find(|v| v.members.iter().any(|m| m.robot == robot))
    }
}
