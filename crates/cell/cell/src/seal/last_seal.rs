//! The last seal of a cell.

/// The last seal of a cell.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct Seal {
    /// The access class.
    pub class: String,
    /// The owner of the key.
    pub name: String,
    /// The short id of the key: the first 16 hex digits of its hash.
    pub key: String,
    /// Time in UTC, by the clock of the author's computer.
    pub time: String,
    /// Number of log entries.
    pub entries: u64,
}
