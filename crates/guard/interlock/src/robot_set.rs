//! Sets of robots.

use crate::RobotSlot;

/// A set of the first 128 robots of a cell, one bit each; other robots cannot be added.
///
/// ```
/// use elbowroom_interlock::{RobotSet, RobotSlot};
/// let set: RobotSet = [RobotSlot(3), RobotSlot(1), RobotSlot(3)].into_iter().collect();
/// assert_eq!(set.iter().collect::<Vec<_>>(), [RobotSlot(1), RobotSlot(3)]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RobotSet(u128);

impl RobotSet {
    /// Robots from this index on cannot be added.
    pub const CAPACITY: usize = 128;

    /// Adds a robot.
    pub fn insert(&mut self, robot: RobotSlot) {
        if robot.0 < Self::CAPACITY {
            self.0 |= 1 << robot.0;
        }
    }

    /// Whether the robot is in the set.
    pub fn contains(self, robot: RobotSlot) -> bool {
        robot.0 < Self::CAPACITY && self.0 >> robot.0 & 1 == 1
    }

    /// Whether the set is empty.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// The robots of this set, the other set or both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The robots of this set that are not in the other set.
    #[must_use]
    pub fn difference(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Iterates over the robots in the order of their indices.
    pub fn iter(self) -> impl Iterator<Item = RobotSlot> {
        let first = |bits: u128| (bits != 0).then_some(bits);
        // Each step drops the lowest bit.
        std::iter::successors(first(self.0), move |bits| first(bits & (bits - 1)))
            .map(|bits| RobotSlot(bits.trailing_zeros() as usize))
    }
}

impl FromIterator<RobotSlot> for RobotSet {
    fn from_iter<I: IntoIterator<Item = RobotSlot>>(robots: I) -> Self {
        let mut set = Self::default();
        robots.into_iter().for_each(|robot| set.insert(robot));
        set
    }
}
