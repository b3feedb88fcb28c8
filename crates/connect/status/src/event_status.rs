//! Status of an event.

use serde::{Deserialize, Serialize};

/// An event, as in `events.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EventStatus {
    /// Time since the service started, s.
    pub t_s: f64,
    /// Name of the robot; empty if the event has none.
    pub robot: String,
    /// Name of the region; empty if the event has none.
    pub region: String,
    /// Name of the event.
    pub event: String,
}
