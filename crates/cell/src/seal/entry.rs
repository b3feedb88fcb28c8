//! A line of the log.

use serde::{Deserialize, Serialize};

use super::change::Change;
use super::keys::{PrivateKey, PublicKey};

/// An edit, by whom, and the state of the cell after it; signed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Counted from 1.
    pub sequence: u64,
    /// When, in UTC, by the clock of whoever edited.
    pub time: String,
    /// The class on whose behalf: `programmer` or `integrator`.
    pub class: String,
    /// Short name of the key that signed.
    pub key: String,
    /// The program that wrote the entry, with its version.
    pub program: String,
    /// What was done: `seal`, `add region.cart`, `change monitor`.
    pub action: String,
    /// Why, in the words of whoever edited.
    pub note: Option<String>,
    /// What differs from the entry before; all that is sealed, in the first.
    pub changes: Vec<Change>,
    /// SHA-256 (hex) of all keys and values that are sealed, after the changes.
    pub state: String,
    /// The cell's checksum, as `run` shows it.
    pub checksum: String,
    /// SHA-256 (hex) of the line before; 64 zeros in the first.
    pub previous: String,
    /// Ed25519 (hex), over this entry without it.
    pub signature: String,
}

impl Entry {
    /// As it stands in the log.
    pub(super) fn line(&self) -> String {
        // Structs of texts and numbers have no reason to fail; were there one, no signature would fit.
        serde_json::to_string(self).unwrap_or_default()
    }

    pub(super) fn parse(line: &str) -> Option<Self> {
        let entry: Self = serde_json::from_str(line).ok()?;
        // Else two lines could tell the same entry, and blanks or a repeated key would go unseen.
        (entry.line() == line).then_some(entry)
    }

    fn unsigned(&self) -> String {
        Self { signature: String::new(), ..self.clone() }.line()
    }

    pub(super) fn signed(mut self, key: &PrivateKey) -> Self {
        self.signature = key.sign(self.unsigned().as_bytes());
        self
    }

    pub(super) fn is_signed_by(&self, key: &PublicKey) -> bool {
        key.has_signed(self.unsigned().as_bytes(), &self.signature)
    }
}
