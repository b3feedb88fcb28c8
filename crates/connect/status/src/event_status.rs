//! What has happened.

use serde::{Deserialize, Serialize};

/// An event, as in `events.csv`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EventStatus {
    /// Time since the service started, s.
    pub t_s: f64,
    /// The robot; empty if it is none.
    pub robot: String,
    /// The region; empty if it is none.
    pub region: String,
    /// What happened.
    pub event: String,
}
