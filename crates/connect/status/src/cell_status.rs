//! Status of a cell: all its robots, and moved objects.

use serde::{Deserialize, Serialize};

use crate::event_status::EventStatus;
use crate::robot_status::{PoseStatus, RobotStatus};

/// The status of a cell at one instant.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CellStatus {
    /// Time since the service started, s.
    pub t_s: f64,
    /// Name of the cell.
    pub cell: String,
    /// Checksum of its configuration.
    pub checksum: String,
    /// Its robots, in the order of the cell file.
    pub robots: Vec<RobotStatus>,
    /// Objects that have moved since the start.
    pub objects: Vec<PlacedStatus>,
    /// The exchange regions and their holders.
    pub slots: Vec<SlotStatus>,
    /// Events since the status before.
    pub events: Vec<EventStatus>,
}

/// An object at a pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlacedStatus {
    /// Its name.
    pub name: String,
    /// Its pose in the world.
    pub pose: PoseStatus,
}

/// Exchange regions that are granted together.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SlotStatus {
    /// The regions.
    pub regions: Vec<String>,
    /// The robot that holds them.
    pub holder: Option<String>,
    /// The robots that wait, in the order of their requests.
    pub queue: Vec<String>,
    /// Age of the arbiter's message, s; 0 if the status is made in the arbiter's process.
    #[serde(default)]
    pub age_s: f64,
}
