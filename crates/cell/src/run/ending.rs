//! When a robot stands still, and when a run is over.

use elbowroom_kinematics::ChainState;

use crate::Cell;
use crate::motion::Clock;

/// A program whose time runs slower than this stands still.
const STOPPED: f64 = 1e-3;
/// It moves again when its time runs faster than this.
const RESUMED: f64 = 1e-2;
/// Joints that moved less than this (rad, m) have not moved: the override law approaches a border without end.
const STILL: f64 = 1e-5;
/// A run ends after this time without motion, s.
const PATIENCE_S: f64 = 1.0;

/// Whether one robot is stopped by the monitor.
#[derive(Debug, Clone, Default)]
pub(super) struct Halt {
    pub stopped: bool,
}

impl Halt {
    /// `stop` or `resume`, where that begins now.
    pub fn update(&mut self, clock: &Clock, obeyed: f64) -> Option<&'static str> {
        let held = clock.moving() && clock.programmed_override() > 0.0;
        if !self.stopped && held && clock.rate() < STOPPED && obeyed < STOPPED {
            self.stopped = true;
            return Some("stop");
        }
        if self.stopped && (!held || clock.rate() > RESUMED) {
            self.stopped = false;
            return Some("resume");
        }
        None
    }
}

/// Watches for the end of all motion.
#[derive(Debug)]
pub(super) struct Ending {
    still_since: f64,
    reference: Vec<Vec<f64>>,
}

impl Ending {
    pub fn new(cell: &Cell) -> Self {
        Self { still_since: 0.0, reference: cell.robots.iter().map(|r| r.start.clone()).collect() }
    }

    /// True after a second without any motion; `progress` counts as motion.
    pub fn nothing_moved(&mut self, t_s: f64, states: &[ChainState], progress: bool) -> bool {
        let far = |(a, b): (&f64, &f64)| (a - b).abs() > STILL;
        let moved = states.iter().zip(&self.reference).any(|(s, r)| s.q.iter().zip(r).any(far));
        if moved || progress {
            self.still_since = t_s;
            for (reference, state) in self.reference.iter_mut().zip(states) {
                reference.copy_from_slice(&state.q);
            }
        }
        t_s - self.still_since >= PATIENCE_S
    }
}
