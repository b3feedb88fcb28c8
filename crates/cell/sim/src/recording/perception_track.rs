//! Observations of the sensors in a run, and the reactions of the robots.

use elbowroom_query::watch::WatchRecord;
use serde::Serialize;

use super::tick_times::TickTimes;

/// Reactions of one robot to the obstacles that sensors see.
#[derive(Debug, Clone, Default)]
pub struct PerceptionTrack {
    /// Searches for a new path, in order of time.
    pub replans: Vec<PathReplan>,
    /// Periods in which it was held, in order.
    pub holds: Vec<HeldPeriod>,
    /// Reason and cause if it was held at the end of the run.
    pub ends_held: Option<(HoldReason, String)>,
}

/// A search for a new path of a planned move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathReplan {
    /// Simulated time, s.
    pub t_s: f64,
    /// Wall-clock time of the search, s.
    pub search_s: f64,
    /// Whether the robot entered the new path in motion; `None` if none was found.
    pub in_motion: Option<bool>,
}

/// A period in which a robot is held: it brakes or waits.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldPeriod {
    /// Start, s.
    pub from_s: f64,
    /// End, s.
    pub to_s: f64,
    /// Why.
    pub reason: HoldReason,
    /// The obstacle (`sensor#number`) or the sensor.
    pub by: String,
}

/// Reason why a robot is held.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum HoldReason {
    /// An obstacle blocks its path.
    Obstacle,
    /// A sensor has sent no usable data for too long, or none yet.
    Stale,
}

/// Observations of one sensor.
#[derive(Debug, Clone)]
pub struct SensorTrack {
    /// Its name.
    pub name: String,
    /// `camera` or `cloud`.
    pub kind: &'static str,
    /// Time from a picture or cloud to its use, s.
    pub latency_s: f64,
    /// One per loaded picture or cloud.
    pub records: Vec<WatchRecord>,
    /// Wall-clock time from the picture in the file to the reaction of the robots.
    pub processing_ns: TickTimes,
}
