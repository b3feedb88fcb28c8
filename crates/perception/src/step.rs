//! Results of the executor: of an obstacle update, and of a tick.

use elbowroom_planner::ReplanKind;

use crate::doing::{ExecutorState, HoldReason};
use crate::times::ReplanTimes;

/// Result of an obstacle update.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReplanResult {
    /// How the current path was found; `None` where there is none, or none was needed.
    pub kind: Option<ReplanKind>,
    /// True where the rest of the path was blocked.
    pub was_blocked: bool,
    /// True where the path was exchanged while the arm moved.
    pub in_motion: bool,
    /// Why there is no path.
    pub reason: Option<HoldReason>,
    /// Wall-clock time per stage.
    pub times: ReplanTimes,
}

/// Result of one control tick.
#[derive(Debug, Clone, PartialEq)]
pub struct ExecutorStep {
    /// All joint values of the robot, radians or metres.
    pub q: Vec<f64>,
    /// Velocities of the map's joints, planar, rad/s.
    pub qd: [f64; 3],
    /// Time scaling rate of the planned trajectory, 0 to 1.
    pub rate: f64,
    /// State of the executor.
    pub state: ExecutorState,
}
