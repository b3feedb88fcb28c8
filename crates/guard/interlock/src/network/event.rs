//! Events of an arbiter, for people and logs.

use crate::{Boot, RobotSlot, SlotId};

/// A change at the arbiter.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum ArbiterEvent {
    /// The robot was granted the slot.
    Granted(SlotId, RobotSlot),
    /// The robot gave the slot up.
    Released(SlotId, RobotSlot),
    /// The robot was found in the slot's regions without a grant while the slot was free; the robot holds the slot now.
    FoundInside(SlotId, RobotSlot),
    /// The second robot was found in the slot's regions while the first one holds the slot.
    Conflict(SlotId, RobotSlot, RobotSlot),
    /// These robots wait for each other, and none of them can stop outside the slot that the next one needs.
    Deadlock(Vec<RobotSlot>),
    /// A guard started again.
    GuardStarted(RobotSlot, Boot),
    /// The robot has another configuration, so it is not trusted.
    OtherConfiguration(RobotSlot),
    /// The integrator declared the silent robot to be outside.
    Cleared(RobotSlot),
    /// A guard obeys a later start of an arbiter: this arbiter started again, with this number.
    StartedAgain(Boot),
}
