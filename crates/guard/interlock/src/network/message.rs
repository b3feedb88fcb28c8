//! The messages between guards and the arbiter.

use crate::{Boot, Occupancy, RobotSlot, Token};

/// From a guard to the arbiter, about every 10 ms.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct StateMessage {
    /// The robot.
    pub robot: RobotSlot,
    /// Start of the guard.
    pub boot: Boot,
    /// Rises with each message of this start.
    pub sequence: u64,
    /// The first 8 bytes of the checksum of the cell's configuration.
    pub checksum: u64,
    /// The start of the arbiter whose grants the guard obeys.
    pub arbiter: Boot,
    /// Per slot of the cell.
    pub slots: Vec<SlotReport>,
}

impl StateMessage {
    /// A message of no guard, with memory for this number of slots, to be written into.
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

/// A robot with respect to one slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SlotReport {
    /// Where the robot is.
    pub occupancy: Occupancy,
    /// The robot requests the slot.
    pub wants: bool,
    /// The grant that the guard obeys.
    pub token: Option<Token>,
    /// This grant and all before it are given up: the guard will never obey one of them again.
    pub released: Option<Token>,
}

impl SlotReport {
    /// Of a guard that does not know where its robot is.
    pub const UNKNOWN: Self = Self { occupancy: Occupancy::Unknown, wants: false, token: None, released: None };
}

/// From the arbiter to a guard: an answer to its last message.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct GrantsMessage {
    /// Of the configuration of the arbiter's cell: a guard of another one does not obey.
    pub checksum: u64,
    /// Start of the arbiter.
    pub arbiter: Boot,
    /// Rises with each message of this start.
    pub serial: u64,
    /// The robot.
    pub robot: RobotSlot,
    /// The start of the guard that is answered.
    pub robot_boot: Boot,
    /// The sequence number of the guard's last message that arrived.
    pub echo: u64,
    /// Per slot of the cell.
    pub slots: Vec<SlotAnswer>,
}

impl GrantsMessage {
    /// A message of no arbiter, with memory for this number of slots, to be written into.
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

/// What a robot is granted of one slot.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct SlotAnswer {
    /// The robot's grant.
    pub granted: Option<Token>,
    /// Give the grant up if the robot can stop outside: otherwise robots wait for each other in a circle.
    pub release_requested: bool,
    /// Stop: another robot was found inside.
    pub halt: bool,
}
