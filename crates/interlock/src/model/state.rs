//! State of a model.

use crate::{Arbiter, GrantsMessage, Guard, Micros, StateMessage};

/// Time of every state.
pub(super) const NOW: Micros = Micros(1_000);

/// Arbiter, guards, robots, and the messages under way between them.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct CellState {
    pub(super) arbiter: Arbiter,
    pub(super) guards: Vec<Guard>,
    pub(super) robots: Vec<RobotState>,
    pub(super) to_arbiter: Vec<Vec<StateMessage>>,
    pub(super) to_guard: Vec<Vec<GrantsMessage>>,
    pub(super) faults: FaultBudget,
}

/// Where a robot is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct RobotState {
    /// Index into its program.
    pub(super) place: usize,
    /// The last tick let it enter the next place, where the next tick will find it.
    pub(super) enters: bool,
}

/// Faults that may still happen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub(super) struct FaultBudget {
    pub(super) guard_crashes: u8,
    pub(super) arbiter_crashes: u8,
    pub(super) clears: u8,
}

impl CellState {
    pub(super) fn slots(&self) -> usize {
        self.guards[0].slots()
    }

    /// The same state where robot `r` has the index `to[r]`.
    pub(super) fn reindexed(&self, to: &[usize]) -> Self {
        let mut other = self.clone();
        other.arbiter = self.arbiter.reindexed(to);
        for (from, to) in to.iter().copied().enumerate() {
            other.robots[to] = self.robots[from];
            other.guards[to] = self.guards[from].clone();
            other.guards[to].set_robot(elbowroom_monitor::RobotSlot(to));
            other.to_arbiter[to] = self.to_arbiter[from].clone();
            other.to_arbiter[to].iter_mut().for_each(|m| m.robot.0 = to);
            other.to_guard[to] = self.to_guard[from].clone();
            other.to_guard[to].iter_mut().for_each(|m| m.robot.0 = to);
        }
        other
    }
}
