//! The messages between guards and the arbiter.

use crate::{Boot, Occupancy, RobotSlot, Token};

/// A message from a guard to the arbiter, sent about every 10 ms.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct StateMessage {
    /// The robot.
    pub robot: RobotSlot,
    /// Start of the guard.
    pub boot: Boot,
    /// Sequence number; rises with each message of this start.
    pub sequence: u64,
    /// The first 8 bytes of the checksum of the cell's configuration.
    pub checksum: u64,
    /// The start of the arbiter whose grants the guard obeys.
    pub arbiter: Boot,
    /// One report per slot of the cell.
    pub slots: Vec<SlotReport>,
}

impl StateMessage {
    /// An empty message with memory for this number of slots, to be written into.
    pub fn with_slots(slots: usize) -> Self {
        Self {
            robot: RobotSlot(0),
            boot: Boot::NONE,
            sequence: 0,
            checksum: 0,
            arbiter: Boot::NONE,
            slots: vec![SlotReport::UNKNOWN; slots],
        }
    }
}

/// A robot's report on one slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SlotReport {
    /// Where the robot is.
    pub occupancy: Occupancy,
    /// True if the robot requests the slot.
    pub wants: bool,
    /// The grant that the guard obeys.
    pub token: Option<Token>,
    /// The last grant given up: the guard will never obey it or an earlier grant again.
    pub released: Option<Token>,
}

impl SlotReport {
    /// The report of a guard that does not know where its robot is.
    pub const UNKNOWN: Self = Self { occupancy: Occupancy::Unknown, wants: false, token: None, released: None };
}

/// A message from the arbiter to a guard, in answer to the guard's last message.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct GrantsMessage {
    /// The first 8 bytes of the checksum of the arbiter's cell configuration; a guard with another configuration does
    /// not obey.
    pub checksum: u64,
    /// Start of the arbiter.
    pub arbiter: Boot,
    /// Serial number; rises with each message of this start.
    pub serial: u64,
    /// The robot.
    pub robot: RobotSlot,
    /// The start of the guard that is answered.
    pub robot_boot: Boot,
    /// The sequence number of the guard's last message that has arrived.
    pub echo: u64,
    /// One answer per slot of the cell.
    pub slots: Vec<SlotAnswer>,
}

impl GrantsMessage {
    /// An empty message with memory for this number of slots, to be written into.
    pub fn with_slots(slots: usize) -> Self {
        Self {
            checksum: 0,
            arbiter: Boot::NONE,
            serial: 0,
            robot: RobotSlot(0),
            robot_boot: Boot::NONE,
            echo: 0,
            slots: vec![SlotAnswer::default(); slots],
        }
    }
}

/// The arbiter's answer for one slot of a robot.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct SlotAnswer {
    /// The robot's grant.
    pub granted: Option<Token>,
    /// Asks the robot to give up the grant if it can stop outside, because robots wait for each other in a cycle.
    pub release_requested: bool,
    /// Orders the robot to stop, because another robot was found inside.
    pub halt: bool,
}
