//! The reported state of the avoidance.

/// The reported state of the avoidance.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum AvoiderState {
    /// On its path.
    #[default]
    Following,
    /// Off its path, correcting its motion near a dynamic obstacle.
    Evading,
    /// Off its path, returning to it or waiting for a detour.
    Returning,
    /// On a planned detour.
    Detouring,
    /// Stationary although its path requires motion.
    Waiting,
    /// The override is 0.
    Halted,
}

impl AvoiderState {
    /// The name for reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Following => "following",
            Self::Evading => "evading",
            Self::Returning => "returning",
            Self::Detouring => "detouring",
            Self::Waiting => "waiting",
            Self::Halted => "halted",
        }
    }
}
