//! Detection of stopped robots.

use crate::motion::ProgramClock;
use crate::recording::RunEvent;

/// Rate below which a program counts as stopped.
const STOPPED: f64 = 1e-3;
/// Rate above which it counts as moving again.
const RESUMED: f64 = 1e-2;

/// Whether the monitor has stopped one robot.
#[derive(Debug, Clone, Default)]
pub(super) struct StopState {
    pub stopped: bool,
}

impl StopState {
    /// Updates the state. Returns `Stop` or `Resume` if the state changes.
    pub fn update(&mut self, clock: &ProgramClock, applied: f64) -> Option<RunEvent> {
        let held = clock.moving() && clock.programmed_override() > 0.0;
        if !self.stopped && held && clock.rate() < STOPPED && applied < STOPPED {
            self.stopped = true;
            return Some(RunEvent::Stop);
        }
        if self.stopped && (!held || clock.rate() > RESUMED) {
            self.stopped = false;
            return Some(RunEvent::Resume);
        }
        None
    }
}
