//! An entry of the control log, and its line.

use serde::{Deserialize, Serialize};

use crate::change::Change;

/// A change of a running cell, and its requester.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ControlEntry {
    /// Counted from 1.
    pub sequence: u64,
    /// Time in UTC, by the clock of the service's computer.
    pub time: String,
    /// The access class of the token.
    pub class: String,
    /// The name of the token.
    pub name: String,
    /// The program that wrote the entry, with its version.
    pub program: String,
    /// The action: `switch region.cart`, `clear robot.left`.
    pub action: String,
    /// The note of the request.
    pub note: Option<String>,
    /// The changes.
    pub changes: Vec<Change>,
    /// The cell's checksum before.
    pub checksum_before: String,
    /// The cell's checksum after; equal to `checksum_before` if no region was edited.
    pub checksum: String,
    /// SHA-256 (hex) of the previous line; 64 zeros in the first entry.
    pub previous: String,
}

impl ControlEntry {
    /// Its line in the log, without the end of the line.
    pub(crate) fn line(&self) -> String {
        // Serialization of texts and numbers cannot fail; an empty line would not be accepted again.
        serde_json::to_string(self).unwrap_or_default()
    }
}
