//! The escape that is examined, and the best one of a tick.

use crate::escape_trajectory::EscapeTrajectory;

/// Gap beyond which escapes are equally good, m.
const ENOUGH_GAP_M: f64 = 0.15;
/// Difference of gaps by which another escape is better, m.
const BETTER_GAP_M: f64 = 0.02;
/// Difference of durations by which another escape is better at the same gap, s.
const BETTER_DURATION_S: f64 = 0.2;

/// What is examined in a tick.
#[derive(Debug)]
pub(crate) struct EscapeTrial {
    pub trajectory: EscapeTrajectory,
    pub target: Vec<f64>,
    /// The best one of the tick.
    pub best: Option<EscapeCandidate>,
    /// Number of the next target.
    pub index: usize,
    /// The next target was begun before.
    pub is_repeated: bool,
}

impl EscapeTrial {
    /// Of a robot at `q`.
    pub fn new(q: &[f64]) -> Self {
        Self {
            trajectory: EscapeTrajectory::new(q.len()),
            target: q.to_vec(),
            best: None,
            index: 0,
            is_repeated: false,
        }
    }
}

/// Quality of an escape.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EscapeCandidate {
    pub gap_m: f64,
    pub duration_s: f64,
}

impl EscapeCandidate {
    /// Whether a larger gap would make it better.
    pub fn may_improve(&self) -> bool {
        self.gap_m < ENOUGH_GAP_M
    }

    /// Largest gap first, as far as it matters, then the least time.
    pub fn is_better_than(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|e| e.gap_m.min(ENOUGH_GAP_M));
        own > others + BETTER_GAP_M
            || (own > others - BETTER_GAP_M && self.duration_s < other.duration_s - BETTER_DURATION_S)
    }
}
