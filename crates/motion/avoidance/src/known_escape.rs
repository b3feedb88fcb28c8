//! The known escape.

use crate::escape_trajectory::EscapeTrajectory;

/// The escape that was proven last; it begins after the last command.
#[derive(Debug)]
pub(crate) struct KnownEscape {
    pub trajectory: EscapeTrajectory,
    pub target: Vec<f64>,
    /// Whether a proven escape is known.
    pub is_proven: bool,
    /// Whether the escape begins at the present state.
    pub is_fresh: bool,
    /// Time since the robot started to follow the escape, s; `None` if it does not follow it.
    pub followed_s: Option<f64>,
    /// Number of ticks in which the escape was examined.
    pub examined: usize,
}

impl KnownEscape {
    /// Creates a memory without an escape, for a robot at `q`.
    pub fn new(q: &[f64]) -> Self {
        Self {
            trajectory: EscapeTrajectory::new(q.len()),
            target: q.to_vec(),
            is_proven: false,
            is_fresh: false,
            followed_s: None,
            examined: 0,
        }
    }

    pub fn forget(&mut self) {
        (self.is_proven, self.followed_s) = (false, None);
    }
}
