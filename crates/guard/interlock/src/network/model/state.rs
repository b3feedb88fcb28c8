//! State of a model.

use super::renaming::permute;
use crate::{Arbiter, GrantsMessage, Guard, Micros, RobotSlot, SlotId, StateMessage};

/// Time of every state.
pub(super) const NOW: Micros = Micros(1_000);

/// Arbiter, guards, robots, and the messages under way between them.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) struct CellState {
    pub(super) arbiter: Arbiter,
    /// Another arbiter, with a lower start.
    pub(super) second: Option<Arbiter>,
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
    /// The place that the last tick let the robot enter, where the next tick will find it.
    pub(super) enters: Option<usize>,
}

/// Faults that may still happen.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub(super) struct FaultBudget {
    pub(super) guard_crashes: u8,
    pub(super) arbiter_crashes: u8,
    pub(super) clears: u8,
    /// Starts of a second arbiter while the first one continues.
    pub(super) second_arbiters: u8,
    /// True if a process may start with a lower number than the former one.
    pub(super) is_set_back: bool,
}

impl FaultBudget {
    /// A number of faults without limit.
    pub(super) const ANY: u8 = u8::MAX;

    pub(super) fn spend(faults: &mut u8) {
        if *faults != Self::ANY {
            *faults -= 1;
        }
    }
}

impl CellState {
    pub(super) fn slots(&self) -> impl Iterator<Item = SlotId> + use<> {
        (0..self.guards[0].slots()).map(SlotId)
    }

    pub(super) fn arbiters(&mut self) -> impl Iterator<Item = &mut Arbiter> {
        std::iter::once(&mut self.arbiter).chain(&mut self.second)
    }

    /// The robot beyond a model of any cell.
    pub(super) fn other(&self) -> RobotSlot {
        RobotSlot(self.guards.len())
    }

    /// Makes the second arbiter the first one, if there is one.
    pub(super) fn swap_arbiters(&mut self) {
        if let Some(second) = &mut self.second {
            std::mem::swap(&mut self.arbiter, second);
        }
    }

    /// Gives robot `r` the index `to[r]`.
    pub(super) fn reindex(&mut self, to: &[usize]) {
        self.arbiters().for_each(|arbiter| arbiter.reindex(to));
        permute(&mut self.robots, to);
        permute(&mut self.guards, to);
        permute(&mut self.to_arbiter, to);
        permute(&mut self.to_guard, to);
    }

    /// Sets the robot indices that guards and messages contain.
    pub(super) fn set_indices(&mut self, index: impl Fn(usize) -> usize) {
        for r in 0..self.guards.len() {
            let robot = RobotSlot(index(r));
            self.guards[r].set_robot(robot);
            self.to_arbiter[r].iter_mut().for_each(|m| m.robot = robot);
            self.to_guard[r].iter_mut().for_each(|m| m.robot = robot);
        }
    }
}
