//! What an arbiter knows of a cell.

use crate::{Micros, SlotId};

/// Settings of an arbiter.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct ArbiterSettings {
    /// The robots of the cell file, each at the index of its [`RobotSlot`](crate::RobotSlot).
    pub robots: Vec<RobotSettings>,
    /// Number of slots.
    pub slots: usize,
    /// The first 8 bytes of the checksum of the cell's configuration; guards with another one are not trusted.
    pub checksum: u64,
    /// Age, on the clock of the arbiter, after which a robot's last message counts as unknown.
    pub silence: Micros,
    /// How long after its request was sent a grant may be obeyed, on the clock of the guard.
    pub validity: Micros,
}

/// What an arbiter knows of a robot.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct RobotSettings {
    /// Its name.
    pub name: String,
    /// The slots that it may ever be in. Others are granted without it.
    pub slots: Vec<SlotId>,
    /// Longest time in which it stops once it may no longer enter, the reaction of its controller included.
    pub stop_time: Micros,
    /// Of robots that wait for a slot the one with the highest priority is granted it first; among equals the first.
    pub priority: i32,
}

impl ArbiterSettings {
    /// A silence of 100 ms, a validity of 50 ms, checksum 0.
    pub fn new(robots: Vec<RobotSettings>, slots: usize) -> Self {
        Self { robots, slots, checksum: 0, silence: Micros(100_000), validity: Micros(50_000) }
    }
}

impl RobotSettings {
    /// A stop time of 1 s, priority 0. A robot that may take longer needs its own: after that time somebody may clear it.
    pub fn new(name: &str, slots: impl IntoIterator<Item = SlotId>) -> Self {
        let slots = slots.into_iter().collect();
        Self { name: name.to_owned(), slots, stop_time: Micros(1_000_000), priority: 0 }
    }
}
