//! The examined escape, and the best escape of a tick.

use crate::escape_trajectory::EscapeTrajectory;

/// Gap beyond which escapes are equally good, m.
const ENOUGH_GAP_M: f64 = 0.15;
/// Smallest difference of gaps that makes another escape better, m.
const BETTER_GAP_M: f64 = 0.02;
/// Smallest difference of durations that makes another escape better at the same gap, s.
const BETTER_DURATION_S: f64 = 0.2;

/// The escapes examined in a tick.
#[derive(Debug)]
pub(crate) struct EscapeTrial {
    pub trajectory: EscapeTrajectory,
    pub target: Vec<f64>,
    /// The best escape of the tick.
    pub best: Option<EscapeCandidate>,
    /// Index of the next target.
    pub index: usize,
    /// Whether the next target was already begun.
    pub is_repeated: bool,
}

impl EscapeTrial {
    /// Creates the trial for a robot at `q`.
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
    /// Whether a larger gap would make the escape better.
    pub fn may_improve(&self) -> bool {
        self.gap_m < ENOUGH_GAP_M
    }

    /// Compares by the larger gap, as far as it matters, then by the shorter duration.
    pub fn is_better_than(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|e| e.gap_m.min(ENOUGH_GAP_M));
        own > others + BETTER_GAP_M
            || (own > others - BETTER_GAP_M && self.duration_s < other.duration_s - BETTER_DURATION_S)
    }
}
