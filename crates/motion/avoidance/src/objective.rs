//! The objective of a tick.

use crate::state_machine::ControlState;
use crate::{Mode, PathKind, Reference};

/// The motion of the robot if nothing has to be evaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Objective {
    /// The reference.
    Path,
    /// The next waypoint of the detour.
    Detour,
    /// Rest.
    Rest,
    /// The path, gently after a recent correction.
    Return { gently: bool },
}

impl Objective {
    pub(crate) fn of(state: &ControlState) -> Self {
        match state {
            ControlState::Following => Self::Path,
            ControlState::Detouring(_) => Self::Detour,
            ControlState::Evading => Self::Return { gently: true },
            ControlState::Holding { .. } => Self::Rest,
            ControlState::Returning { .. } => Self::Return { gently: false },
        }
    }

    /// The mode of the reactive controller.
    pub(crate) fn mode(self, reference: &Reference<'_>) -> Mode {
        match (self, reference.path) {
            (Self::Detour, _) => Mode::Detour,
            (Self::Return { .. } | Self::Rest, _) => Mode::Return,
            (Self::Path, PathKind::Continuous) => Mode::KeepPath,
            // Obstacles may be near a robot at rest.
            (Self::Path, PathKind::PointToPoint) if reference.qd.iter().all(|v| *v == 0.0) => Mode::KeepPath,
            (Self::Path, PathKind::PointToPoint) => Mode::Transit,
        }
    }
}
