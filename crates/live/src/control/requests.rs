//! What may be asked of a running cell, as JSON.

use serde::Deserialize;

/// Switches a temporary region.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Switch {
    /// The region.
    pub(crate) region: String,
    /// On or off.
    pub(crate) active: bool,
    /// Why, for the log.
    pub(crate) note: Option<String>,
}

/// Declares that a silent robot is at rest outside of exchange regions, which whoever asks has seen.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Clear {
    /// The robot.
    pub(crate) robot: String,
    /// All its exchange regions: whoever asks has seen it outside of each.
    pub(crate) regions: Vec<String>,
    /// The robot once more.
    pub(crate) repeat_robot: String,
    /// Why, for the log.
    pub(crate) note: Option<String>,
}
