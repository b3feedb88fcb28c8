//! The escape that is known.

use crate::escape_trajectory::EscapeTrajectory;

/// The escape that was proven last: it begins after the last command.
#[derive(Debug)]
pub(crate) struct KnownEscape {
    pub trajectory: EscapeTrajectory,
    pub target: Vec<f64>,
    /// Whether there is one.
    pub is_proven: bool,
    /// It begins at the present state.
    pub is_fresh: bool,
    /// Time since the robot follows it, s; `None` if it does not.
    pub followed_s: Option<f64>,
    /// Number of ticks in which it was examined.
    pub examined: usize,
}

impl KnownEscape {
    /// None, for a robot at `q`.
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
