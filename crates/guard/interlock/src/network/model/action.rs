//! Steps of a model.

use crate::{Boot, RobotSlot, SlotId};

/// What a robot does in a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    /// The robot completes what the last tick let it do.
    Remain,
    /// The tick finds the robot at this place, for which it needs no grant.
    Advance(usize),
    /// The tick lets the robot enter this place, where the next tick will find it.
    Enter(usize),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Action {
    Tick(RobotSlot, Step),
    /// The guard sends a message.
    Send(RobotSlot),
    /// The guard sends a message after it was asked to give up its grants.
    SendAsked(RobotSlot),
    ToGuard(RobotSlot, usize),
    TimePasses,
    CrashGuard(RobotSlot, Boot),
    Arbiter(ArbiterStep),
    /// A step of the other arbiter.
    SecondArbiter(ArbiterStep),
    /// Another arbiter starts, while the first one continues.
    StartSecondArbiter(Boot),
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ArbiterStep {
    /// The arbiter receives a message, which may be delivered again.
    Receive(RobotSlot, usize, Next),
    Clear(RobotSlot, Next),
    /// The arbiter starts again with this number.
    Crash(Boot),
    TakeBack(SlotId),
    /// The arbiter receives a message of a robot beyond the model.
    Other(Report, Next),
    /// The arbiter sends an answer because of a slot beyond the model.
    Answer(RobotSlot),
}

/// The robot that the arbiter considers for a grant in its next step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Next {
    /// The arbiter's own choice, in models without other robots; otherwise no robot.
    Undecided,
    Robot(RobotSlot),
    /// A robot beyond the model.
    Other,
}

/// What a robot beyond the model reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Report {
    /// It is outside, and gives up the slot.
    Outside,
    /// It can no longer stop outside, or does not know that it can.
    Committed,
    Inside,
}
