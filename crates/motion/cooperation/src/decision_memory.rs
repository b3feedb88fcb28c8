//! What the decisions of a virtual robot remember.

use crate::HandOverReason;

/// Time for which a receiver that gave up is not asked again, s.
const REFUSED_S: f64 = 3.0;

/// What the decision remembers.
#[derive(Debug)]
pub(crate) struct DecisionMemory {
    /// Time since the last hand-over, s.
    pub since_s: f64,
    /// Per holding: time for which it is not asked, s.
    pub refused_s: Vec<f64>,
    /// The forecast whose turn it is.
    pub turn: usize,
    /// Time for which the work-piece has stood where the hand of the holder could not move back any more, s.
    pub no_retreat_s: f64,
    /// Why the present hand-over was decided.
    pub reason: Option<HandOverReason>,
}

impl DecisionMemory {
    pub fn new(holdings: usize) -> Self {
        Self { since_s: f64::INFINITY, refused_s: vec![0.0; holdings], turn: 0, no_retreat_s: 0.0, reason: None }
    }

    /// A receiver gave up.
    pub fn refuse(&mut self, holding: usize) {
        self.refused_s[holding] = REFUSED_S;
    }

    /// The work-piece was handed over.
    pub fn handed_over(&mut self) {
        (self.since_s, self.no_retreat_s) = (0.0, 0.0);
    }
}
