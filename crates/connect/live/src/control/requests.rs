//! Requests to a running cell, as JSON.

use serde::Deserialize;

/// Switches a temporary region.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Switch {
    /// The region.
    pub(crate) region: String,
    /// On or off.
    pub(crate) active: bool,
    /// Reason, for the log.
    pub(crate) note: Option<String>,
}

/// Declares that a silent robot is at rest outside its exchange regions; the sender has seen it.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Clear {
    /// The robot.
    pub(crate) robot: String,
    /// All its exchange regions: the sender has seen the robot outside each of them.
    pub(crate) regions: Vec<String>,
    /// The robot again, to confirm.
    pub(crate) repeat_robot: String,
    /// Reason, for the log.
    pub(crate) note: Option<String>,
}

/// Moves a region to another place.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Move {
    /// The region.
    pub(crate) region: String,
    /// Keys of the cell file for the new place, such as `centre = [0, 0, 900]`.
    pub(crate) toml: String,
    /// Reason, for the log.
    pub(crate) note: Option<String>,
}

/// Adds a region.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Add {
    /// Name of the region.
    pub(crate) region: String,
    /// Keys of the region as in the cell file, or its table `[region.NAME]`.
    pub(crate) toml: String,
    /// Whether the region is on; default: on.
    pub(crate) active: Option<bool>,
    /// Reason, for the log.
    pub(crate) note: Option<String>,
}

/// Asks for the distance of a robot from a region that is being taught. It changes nothing.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Taught {
    /// The robot.
    pub(crate) robot: String,
    /// Name of the region.
    pub(crate) region: String,
    /// Keys of the region as in the cell file, or its table `[region.NAME]`.
    pub(crate) toml: String,
}

/// Removes a region.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Remove {
    /// The region.
    pub(crate) region: String,
    /// Reason, for the log.
    pub(crate) note: Option<String>,
}
