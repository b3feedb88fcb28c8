//! Indices of robots and locks in a zone arbiter.

/// Index of a robot in a [`ZoneArbiter`](crate::ZoneArbiter).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RobotSlot(pub usize);

/// Index of a lock in a [`ZoneArbiter`](crate::ZoneArbiter).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SlotId(pub usize);
