//! The output of a tick besides the joint command.

use std::time::Duration;

use crate::state::AvoiderState;
use crate::{EscapeState, Reaction};

/// Durations of the stages of a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StageTimes {
    /// Updating the scene and finding proximity pairs.
    pub sense: Duration,
    /// Rules and least squares.
    pub correct: Duration,
    /// Sweep between this command and the next.
    pub check: Duration,
    /// Search for escapes.
    pub escape: Duration,
}

impl StageTimes {
    /// The sum of all stages.
    pub fn total(&self) -> Duration {
        self.sense + self.correct + self.check + self.escape
    }
}

/// The output of a tick besides the joint command.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AvoiderOutput {
    /// Rate at which the path may advance, as a fraction of its full rate, 0 to 1.
    pub rate: f64,
    /// The reported state.
    pub state: AvoiderState,
    /// The reaction of the reactive controller.
    pub reaction: Reaction,
    /// Distance to the nearest dynamic obstacle, m; infinite if none is near.
    pub nearest_m: f64,
    /// Key of the dynamic obstacle that requested the largest correction.
    pub governed_by: Option<usize>,
    /// Deviation from the path, in seconds of joint motion at full speed.
    pub path_deviation_s: f64,
    /// Whether the command was replaced by braking, because the sweep found that the command, or a stop after it, would
    /// collide.
    pub braked: bool,
    /// Result of the search for escapes.
    pub escape: EscapeState,
    /// Computing time of the search for escapes, µs, counted in elementary tests times their measured costs: equal in
    /// every run.
    pub escape_work_us: u64,
    /// Whether a detour should be planned ([`crate::Avoider::plan_to`]): the robot is stationary off its path with no
    /// dynamic obstacle to evade, or has been stalled for the stall timeout by stationary obstacles. While a passing
    /// obstacle is still in the way, planning fails: plan again half a second later.
    pub requests_detour: bool,
    /// Durations of the stages.
    pub times: StageTimes,
}
