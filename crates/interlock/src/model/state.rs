//! State of a model.

use crate::{Arbiter, GrantsMessage, Guard, Micros, StateMessage};

/// Time of every state.
pub(super) const NOW: Micros = Micros(1_000);

/// Arbiter, guards, robots, and the messages under way between them.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct CellState {
    pub(super) arbiter: Arbiter,
    pub(super) guards: Vec<Guard>,
    /// Index into the robot's program.
    pub(super) places: Vec<usize>,
    pub(super) to_arbiter: Vec<Vec<StateMessage>>,
    pub(super) to_guard: Vec<Vec<GrantsMessage>>,
    pub(super) guard_crashes: u8,
    pub(super) arbiter_crashes: u8,
    pub(super) clears: u8,
    pub(super) boots: u64,
}
