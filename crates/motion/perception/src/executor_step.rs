//! Result of a control tick.

use crate::executor_state::ExecutorState;

/// Result of one control tick.
#[derive(Debug, Clone, PartialEq)]
pub struct ExecutorStep {
    /// All joint values of the robot, radians or metres.
    pub q: Vec<f64>,
    /// Velocities of the map's joints, rad/s: of map joint values (sign removed).
    pub qd: [f64; 3],
    /// Time scaling rate of the planned trajectory, 0 to 1.
    pub rate: f64,
    /// State of the executor.
    pub state: ExecutorState,
}
