//! What an arbiter did, for people and logs.

use crate::{Boot, RobotSlot, SlotId};

/// A change at the arbiter.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum ArbiterEvent {
    /// The robot was granted the slot.
    Granted(SlotId, RobotSlot),
    /// The robot gave the slot up.
    Released(SlotId, RobotSlot),
    /// The robot was found in the slot's regions without a grant, while nobody held it: it holds the slot now.
    FoundInside(SlotId, RobotSlot),
    /// The second robot was found in the slot's regions while the first holds it.
    Conflict(SlotId, RobotSlot, RobotSlot),
    /// These robots wait for each other, and none can stop outside of what the next one needs.
    Deadlock(Vec<RobotSlot>),
    /// A guard started again.
    GuardStarted(RobotSlot, Boot),
    /// The robot's configuration is another one: it is not trusted.
    OtherConfiguration(RobotSlot),
    /// The integrator declared the silent robot to be outside.
    Cleared(RobotSlot),
    /// Guards obey a later start of an arbiter: this one began again, with this number.
    StartedAgain(Boot),
}
