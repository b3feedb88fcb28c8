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

/// Puts a region elsewhere.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Move {
    /// The region.
    pub(crate) region: String,
    /// The keys of the cell file that say where it is: `centre = [0, 0, 900]`.
    pub(crate) toml: String,
    /// Why, for the log.
    pub(crate) note: Option<String>,
}

/// Adds a region.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Add {
    /// Its name.
    pub(crate) region: String,
    /// Its keys, as in the cell file; or the table `[region.NAME]`.
    pub(crate) toml: String,
    /// Whether it is on; so it is without this.
    pub(crate) active: Option<bool>,
    /// Why, for the log.
    pub(crate) note: Option<String>,
}

/// Removes a region.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Remove {
    /// The region.
    pub(crate) region: String,
    /// Why, for the log.
    pub(crate) note: Option<String>,
}
