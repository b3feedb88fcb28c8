//! What a run with operators tells in numbers.

use serde::Serialize;

use crate::recording::{GuidanceSample, RobotTrack};

/// Guidance of a robot by its operator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OperatorSummary {
    /// Name of the operator.
    pub name: String,
    /// The robot.
    pub robot: String,
    /// Time in which the tool followed without a surface, s.
    pub free_s: f64,
    /// Time at surfaces, s.
    pub contact_s: f64,
    /// Time in which it had no wish to follow, was stopped by the monitor, or could not follow, s.
    pub stopped_s: f64,
    /// Least distance between tool and surfaces, m; null if none was near.
    pub least_gap_m: Option<f64>,
    /// Largest change of the tool's velocity from one tick to the next, m/s.
    pub largest_speed_change_m_s: f64,
    /// Largest force on the hand, N; omitted without forces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest_force_n: Option<f64>,
    /// Energy that was put in and not given back at the end, J; omitted without forces.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy_j: Option<f64>,
}

impl OperatorSummary {
    /// Summary of a robot; `None` for a robot without operator.
    pub fn of(robot: &RobotTrack, tick_s: f64) -> Option<Self> {
        let track = robot.guidance.as_ref()?;
        let time =
            |which: fn(&GuidanceSample) -> bool| track.samples.iter().filter(|s| which(s)).count() as f64 * tick_s;
        let forces = || track.samples.iter().filter_map(|s| s.force);
        let change = |w: &[GuidanceSample]| w[0].velocity.distance(w[1].velocity);
        Some(Self {
            name: track.operator.clone(),
            robot: robot.name.clone(),
            free_s: time(|s| s.follows() && s.active == 0),
            contact_s: time(|s| s.follows() && s.active > 0),
            stopped_s: time(|s| !s.follows()),
            least_gap_m: track.samples.iter().filter_map(|s| s.gap_m).reduce(f64::min),
            largest_speed_change_m_s: track.samples.windows(2).map(change).fold(0.0, f64::max),
            largest_force_n: forces().map(|f| f.on_hand_n.length()).reduce(f64::max),
            energy_j: forces().next_back().map(|f| f.energy_j),
        })
    }
}
