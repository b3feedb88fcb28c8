//! Detection of the end of all motion, which ends a run.

use elbowroom_cell::Cell;
use elbowroom_kinematics::ChainState;

/// Joint motion below which a joint counts as stationary (rad, m): the override law approaches a border asymptotically.
const STATIONARY: f64 = 1e-5;

/// Detects the end of all motion.
#[derive(Debug)]
pub(super) struct IdleDetector {
    timeout_s: f64,
    idle_since_s: f64,
    reference: Vec<Vec<f64>>,
}

impl IdleDetector {
    /// Creates a detector for periods of this length (s) without motion.
    pub fn new(cell: &Cell, timeout_s: f64) -> Self {
        Self { timeout_s, idle_since_s: 0.0, reference: cell.robots.iter().map(|r| r.start.clone()).collect() }
    }

    /// True after the timeout without any motion; `progress` counts as motion.
    pub fn is_idle(&mut self, t_s: f64, states: &[ChainState], progress: bool) -> bool {
        let far = |(a, b): (&f64, &f64)| (a - b).abs() > STATIONARY;
        let moved = states.iter().zip(&self.reference).any(|(s, r)| s.q.iter().zip(r).any(far));
        if moved || progress {
            self.idle_since_s = t_s;
            for (reference, state) in self.reference.iter_mut().zip(states) {
                reference.copy_from_slice(&state.q);
            }
        }
        t_s - self.idle_since_s >= self.timeout_s
    }
}
