//! What an arbiter knows of a slot.

use elbowroom_monitor::RobotSlot;

use crate::Token;

/// One slot.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub(crate) struct SlotRecord {
    pub(crate) holder: Option<Holder>,
    /// Robots that wait, in the order of their requests.
    pub(crate) queue: Vec<RobotSlot>,
    /// Robots that were found inside while another one held the slot, until they are seen outside or cleared.
    pub(crate) intruders: Vec<RobotSlot>,
    /// The holder is asked to give the slot up.
    pub(crate) release_requested: bool,
}

/// The robot that holds a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) struct Holder {
    pub(crate) robot: RobotSlot,
    /// `None` where its guard has started again and has not reported where the robot is: neither confirmed nor given to others.
    pub(crate) token: Option<Token>,
}

impl SlotRecord {
    pub(crate) fn is_held_by(&self, robot: RobotSlot) -> bool {
        self.holder.is_some_and(|holder| holder.robot == robot)
    }

    /// The grant of this robot.
    pub(crate) fn token_of(&self, robot: RobotSlot) -> Option<Token> {
        self.holder.filter(|holder| holder.robot == robot).and_then(|holder| holder.token)
    }
}
