//! Sets of robots.

use super::slot::RobotSlot;

/// A set of the first 128 robots, one bit each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct RobotSet(pub(super) u128);

impl RobotSet {
    pub(super) const CAPACITY: usize = 128;

    pub(super) fn insert(&mut self, robot: RobotSlot) {
        if robot.0 < Self::CAPACITY {
            self.0 |= 1 << robot.0;
        }
    }

    pub(super) fn contains(self, robot: RobotSlot) -> bool {
        robot.0 < Self::CAPACITY && self.0 >> robot.0 & 1 == 1
    }

    pub(super) fn iter(self) -> impl Iterator<Item = RobotSlot> {
        (0..Self::CAPACITY).map(RobotSlot).filter(move |r| self.contains(*r))
    }
}
