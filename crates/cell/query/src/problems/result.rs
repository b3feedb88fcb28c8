//! Result of one problem.

use std::time::Duration;

use elbowroom_planner::AnytimePath;
use serde::Serialize;

use super::Unsolved;
use super::problem_scene::Motion;

/// Result of one problem. Missing values are null: times of an invalid problem, lengths without a path.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProblemResult {
    /// Name of the set.
    pub set: String,
    /// Key in the set.
    pub id: String,
    /// Motion that the request names: `LIN`, `PTP`; otherwise `None`.
    pub motion: Option<&'static str>,
    /// True if the start and at least one goal are free.
    pub valid: bool,
    /// True if a path was found.
    pub found: bool,
    /// True if every stretch of the path is proven free.
    pub proven: bool,
    /// Reason why the problem is invalid, why no path was found, or why the path is not timed.
    pub reason: Option<String>,
    /// Time of the search, µs.
    pub planning_us: Option<f64>,
    /// Time of shortcutting, µs.
    pub simplify_us: Option<f64>,
    /// Length in joint space before shortcutting, rad (and m).
    pub cost_raw_rad: Option<f64>,
    /// Length in joint space, rad (and m).
    pub cost_rad: Option<f64>,
    /// Each path that was the shortest so far: one, or several with [`optimize`](super::ProblemSettings::optimize).
    pub improvements: Vec<Improvement>,
    /// Duration of the timed path, s.
    pub duration_s: Option<f64>,
    /// Largest distance of the link that a linear motion moves from its line, m.
    pub line_deviation_m: Option<f64>,
    /// Largest rotation of that link from the orientation on the line, rad.
    pub line_deviation_rad: Option<f64>,
}

/// A path that was the shortest so far.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Improvement {
    /// Time from the beginning of the search until the path was found and shortened, µs.
    pub time_us: f64,
    /// Length in joint space, rad (and m).
    pub cost_rad: f64,
}

impl Improvement {
    fn of(&(time, cost_rad): &(Duration, f64)) -> Self {
        Self { time_us: micros(time), cost_rad }
    }
}

impl ProblemResult {
    pub(super) fn invalid([set, id]: [&str; 2], motion: Motion, reason: String) -> Self {
        Self {
            set: set.to_owned(),
            id: id.to_owned(),
            motion: match motion {
                Motion::Any => None,
                Motion::PointToPoint => Some("PTP"),
                Motion::Linear(_) => Some("LIN"),
            },
            valid: false,
            found: false,
            proven: false,
            reason: Some(reason),
            planning_us: None,
            simplify_us: None,
            cost_raw_rad: None,
            cost_rad: None,
            improvements: Vec::new(),
            duration_s: None,
            line_deviation_m: None,
            line_deviation_rad: None,
        }
    }

    pub(super) fn of(key: [&str; 2], motion: Motion, solution: &Result<AnytimePath, Unsolved>) -> Self {
        let of_valid = Self { valid: true, reason: None, ..Self::invalid(key, motion, String::new()) };
        match solution {
            Ok(AnytimePath { path, improvements, .. }) => Self {
                found: true,
                proven: true,
                planning_us: Some(micros(path.planning_time)),
                simplify_us: Some(micros(path.simplification_time)),
                cost_raw_rad: Some(path.raw_length_rad),
                cost_rad: Some(path.length_rad),
                improvements: improvements.iter().map(Improvement::of).collect(),
                ..of_valid
            },
            Err(Unsolved { reason, planning }) => {
                Self { planning_us: Some(micros(*planning)), reason: Some(reason.clone()), ..of_valid }
            }
        }
    }
}

/// Microseconds with their fraction.
fn micros(time: Duration) -> f64 {
    time.as_nanos() as f64 / 1000.0
}
