//! Indices of robots and slots.

/// Index of a robot of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RobotSlot(pub usize);

/// Index of a slot: exchange regions that are granted together, to one robot at a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SlotId(pub usize);
