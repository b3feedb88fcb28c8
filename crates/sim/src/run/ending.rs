//! Detection of stopped robots, and of the end of a run.

use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;

use crate::motion::ProgramClock;
use crate::recording::RunEvent;

/// Below this rate a program counts as stopped.
const STOPPED: f64 = 1e-3;
/// Above this rate it counts as moving again.
const RESUMED: f64 = 1e-2;
/// Joints that moved less than this (rad, m) count as stationary: the override law approaches a border asymptotically.
const STATIONARY: f64 = 1e-5;
/// A run ends after this time without motion, s.
const IDLE_TIMEOUT_S: f64 = 1.0;

/// Whether the monitor has stopped one robot.
#[derive(Debug, Clone, Default)]
pub(super) struct StopState {
    pub stopped: bool,
}

impl StopState {
    /// `Stop` or `Resume`, where that happens now.
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

/// Detects the end of all motion.
#[derive(Debug)]
pub(super) struct IdleDetector {
    idle_since_s: f64,
    reference: Vec<Vec<f64>>,
}

impl IdleDetector {
    pub fn new(cell: &Cell) -> Self {
        Self { idle_since_s: 0.0, reference: cell.robots.iter().map(|r| r.start.clone()).collect() }
    }

    /// True after a second without any motion; `progress` counts as motion.
    pub fn is_idle(&mut self, t_s: f64, states: &[ChainState], progress: bool) -> bool {
        let far = |(a, b): (&f64, &f64)| (a - b).abs() > STATIONARY;
        let moved = states.iter().zip(&self.reference).any(|(s, r)| s.q.iter().zip(r).any(far));
        if moved || progress {
            self.idle_since_s = t_s;
            for (reference, state) in self.reference.iter_mut().zip(states) {
                reference.copy_from_slice(&state.q);
            }
        }
        t_s - self.idle_since_s >= IDLE_TIMEOUT_S
    }
}
