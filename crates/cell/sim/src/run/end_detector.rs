//! Detection of the end of a run: all motion has ended, except motion that never ends.

use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;

use super::idle_detector::IdleDetector;
use crate::recording::RunEnd;

/// Time without motion after which a run ends, s.
const IDLE_TIMEOUT_S: f64 = 1.0;
/// Time after which a run ends if the robots are stopped at override 0 and only endless belts move, s.
const STANDSTILL_TIMEOUT_S: f64 = 10.0;

/// Detects that all motion has ended, except motion that never ends.
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
