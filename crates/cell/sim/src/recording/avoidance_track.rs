//! Evasion of a robot in a run.

use elbowroom_avoidance::fuzzy::Surface;
use elbowroom_avoidance::{AvoiderState, EscapeState};
use serde::Serialize;

use super::tick_times::TickTimes;

/// Evasion of one robot.
#[derive(Debug, Clone, Default)]
pub struct AvoidanceTrack {
    /// One per tick, like the samples of the robot.
    pub samples: Vec<AvoidanceSample>,
    /// Names of possible obstacles: objects, then `robot/link`.
    pub obstacles: Vec<String>,
    /// Wall-clock time of its steps: sensing, correction, check, command.
    pub step_ns: TickTimes,
    /// Its evasions, in order of time.
    pub evasions: Vec<Evasion>,
    /// Replanning attempts, in order of time.
    pub plans: Vec<ReplanRecord>,
    /// Its rules: one control surface per output.
    pub surfaces: Vec<Surface>,
}

/// The beginning of an evasion: the chain that ends in the collision point is steered (Reichenbach and Kovačić, 2003).
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Evasion {
    /// Simulated time, s.
    pub t_s: f64,
    /// The obstacle, an object or `robot/link`; null for a part of the cell that does not move by itself.
    pub obstacle: Option<String>,
    /// The link of the collision point.
    pub link: String,
    /// The point in the frame of the link, m, as `inspect --at` takes it.
    pub in_link_m: [f64; 3],
    /// Its distance from the obstacle, m.
    pub distance_m: f64,
    /// The independent joints that move it, from the base outwards.
    pub moved_by: Vec<String>,
}

/// One replanning attempt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplanRecord {
    /// Simulated time of the attempt, s.
    pub t_s: f64,
    /// Wall-clock time of the search, s; `None` if no path was found.
    pub search_s: Option<f64>,
}

/// Evasion at one tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AvoidanceSample {
    /// State of the avoider.
    pub state: AvoiderState,
    /// Smallest separation distance to any obstacle, m; infinite if none is near.
    pub nearest_m: f64,
    /// Size of the correction, 0..1.
    pub size: f64,
    /// Path deviation: seconds of joint motion at full speed back to the path.
    pub path_deviation_s: f64,
    /// Rate at which the path may advance, 0..1.
    pub rate: f64,
    /// The dynamic obstacle that requested the largest correction, an index in [`AvoidanceTrack::obstacles`].
    pub governed_by: Option<usize>,
    /// State of the search for escapes.
    pub escape: EscapeState,
}
