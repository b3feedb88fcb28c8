//! Result of an obstacle update.

use elbowroom_planner::ReplanKind;

use crate::executor_state::HoldReason;
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
