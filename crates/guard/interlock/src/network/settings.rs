//! Settings of an arbiter: its knowledge of a cell.

use crate::{Micros, SlotId};

/// Settings of an arbiter.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct ArbiterSettings {
    /// The robots of the cell file, each at the index of its [`RobotSlot`](crate::RobotSlot).
    pub robots: Vec<RobotSettings>,
    /// Number of slots.
    pub slots: usize,
    /// The first 8 bytes of the checksum of the cell's configuration; guards with another checksum are not trusted.
    pub checksum: u64,
    /// Age, on the arbiter's clock, above which a robot's last message does not count: the robot is unknown.
    pub silence: Micros,
    /// Time for which a grant may be obeyed after its request was sent, on the guard's clock.
    pub validity: Micros,
}

/// Settings of a robot.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct RobotSettings {
    /// The robot's name.
    pub name: String,
    /// The slots that the robot may ever be in. All other slots are granted without it.
    pub slots: Vec<SlotId>,
    /// Longest time in which the robot stops once it may no longer enter, including the reaction of its controller.
    pub stop_time: Micros,
    /// Priority: of the robots that wait for a slot, the one with the highest priority is granted it first; among
    /// equals, the first to wait.
    pub priority: i32,
}

impl ArbiterSettings {
    /// Settings with a silence of 100 ms, a validity of 50 ms and checksum 0.
    pub fn new(robots: Vec<RobotSettings>, slots: usize) -> Self {
        Self { robots, slots, checksum: 0, silence: Micros(100_000), validity: Micros(50_000) }
    }
}

impl RobotSettings {
    /// Settings with a stop time of 1 s and priority 0. A robot that may take longer needs its own stop time: after that
    /// time somebody may clear it.
    pub fn new(name: &str, slots: impl IntoIterator<Item = SlotId>) -> Self {
        let slots = slots.into_iter().collect();
        Self { name: name.to_owned(), slots, stop_time: Micros(1_000_000), priority: 0 }
    }
}
