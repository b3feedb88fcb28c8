//! What one step of a virtual robot did.

use elbowroom_robot::GeometryId;

use crate::HoldLimit;

/// Why the work-piece stands although it should move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// A monitor has stopped an arm that carries it: override 0, or an override that is not a number.
    Override,
    /// An arm that carries it, by its index, cannot go on.
    Limit(usize, HoldLimit),
    /// Nothing is desired: the enabling switch is open, or the input is old.
    Paused,
    /// An arm, by its index, must first get out of the way.
    InTheWay(usize),
    /// Two arms would be too near to each other.
    Contact(GeometryId, GeometryId),
    /// A motion could not be proven free.
    Unproven,
    /// The step has no positive, finite duration, or not one override per arm.
    Input,
}

/// The work-piece went from one arm to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandedOver {
    /// Index of the arm that gave it.
    pub from: usize,
    /// Index of the arm that holds it now.
    pub to: usize,
    /// Why it was decided.
    pub reason: HandOverReason,
}

/// Why a hand-over was decided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HandOverReason {
    /// What the giver would have come to.
    pub limit: Option<HoldLimit>,
    /// In which time, s.
    pub giver_holds_s: f64,
    /// How long the receiver can hold, s; infinite beyond the horizon.
    pub receiver_holds_s: f64,
    /// Foreseen duration until the receiver holds it, s.
    pub takes_s: f64,
}

/// What one step of a virtual robot did.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CooperationStep {
    /// Share of the desired speed, 0 to 1.
    pub rate: f64,
    /// Why the work-piece stands although it should move.
    pub hold: Option<Hold>,
    /// A hand-over, in the step in which the receiver takes the work-piece.
    pub handed_over: Option<HandedOver>,
}
