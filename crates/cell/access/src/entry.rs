//! An entry of the edit log.

use serde::{Deserialize, Serialize};

use crate::change::Change;
use crate::keys::{PrivateKey, PublicKey};

/// An edit, its author, and the state of the cell after it; signed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogEntry {
    /// Counted from 1.
    pub sequence: u64,
    /// Time in UTC, by the clock of the author's computer.
    pub time: String,
    /// The access class: `programmer` or `integrator`.
    pub class: String,
    /// Short id of the signing key.
    pub key: String,
    /// The program that wrote the entry, with its version.
    pub program: String,
    /// The action: `seal`, `add region.cart`, `change monitor`.
    pub action: String,
    /// The author's note.
    pub note: Option<String>,
    /// Changes since the last entry; everything sealed, in the first one.
    pub changes: Vec<Change>,
    /// SHA-256 (hex) of all sealed keys and values after the changes.
    pub state: String,
    /// The cell's checksum, as printed by `run`.
    pub checksum: String,
    /// SHA-256 (hex) of the previous line; 64 zeros in the first entry.
    pub previous: String,
    /// Ed25519 signature (hex) of this entry with an empty signature.
    pub signature: String,
}

impl LogEntry {
    /// The line in the log.
    pub fn line(&self) -> String {
        // Serialization of texts and numbers cannot fail; an empty line would fail the signature check.
        serde_json::to_string(self).unwrap_or_default()
    }

    /// Reads a line of the log; `None` if it is not exactly as [`line`](Self::line) writes it.
    pub fn parse(line: &str) -> Option<Self> {
        let entry: Self = serde_json::from_str(line).ok()?;
        // Only the canonical form is accepted: otherwise spaces or repeated keys would go unnoticed.
        (entry.line() == line).then_some(entry)
    }

    fn unsigned(&self) -> String {
        Self { signature: String::new(), ..self.clone() }.line()
    }

    /// Signs the entry.
    #[must_use]
    pub fn signed(mut self, key: &PrivateKey) -> Self {
        self.signature = key.sign(self.unsigned().as_bytes());
        self
    }

    /// Whether a key has signed the entry.
    pub fn is_signed_by(&self, key: &PublicKey) -> bool {
        key.has_signed(self.unsigned().as_bytes(), &self.signature)
    }
}
