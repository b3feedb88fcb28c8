//! Detection of the end of a run: nothing moves any more, or only what never ends.

use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;

use super::idle_detector::IdleDetector;
use crate::recording::RunEnd;

/// A run ends after this time without motion, s.
const IDLE_TIMEOUT_S: f64 = 1.0;
/// A run ends after this time in which the robots stand at override 0 and only endless belts move, s.
const STANDSTILL_TIMEOUT_S: f64 = 10.0;

/// Detects that nothing moves any more, or only what never ends.
#[derive(Debug)]
pub(super) struct EndDetector {
    idle: IdleDetector,
    standstill: IdleDetector,
}

impl EndDetector {
    pub fn new(cell: &Cell) -> Self {
        let detector = |timeout_s| IdleDetector::new(cell, timeout_s);
        Self { idle: detector(IDLE_TIMEOUT_S), standstill: detector(STANDSTILL_TIMEOUT_S) }
    }

    /// Observes an instant; `moves` and `can_continue` count as motion.
    pub fn end(&mut self, t_s: f64, states: &[ChainState], moves: bool, can_continue: bool) -> Option<RunEnd> {
        if self.idle.is_idle(t_s, states, moves) {
            return Some(RunEnd::Rest);
        }
        self.standstill.is_idle(t_s, states, can_continue).then_some(RunEnd::Standstill)
    }
}
