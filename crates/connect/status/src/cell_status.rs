//! The status of a cell: all its robots, and what else moves.

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
    /// The exchange regions and who holds them.
    pub slots: Vec<SlotStatus>,
    /// What happened since the status before.
    pub events: Vec<EventStatus>,
}

/// A thing at a pose.
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
    /// The robots that wait, first come first.
    pub queue: Vec<String>,
    /// How long ago the arbiter said so, s; 0 if this is put together in its process.
    #[serde(default)]
    pub age_s: f64,
}
