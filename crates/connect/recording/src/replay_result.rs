//! Result of a replay.

use serde::Serialize;

/// Result of a replay.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Replay {
    /// Name of the cell.
    pub cell: String,
    /// Checksum of its configuration.
    pub checksum: String,
    /// Messages in the recording.
    pub messages: u64,
    /// Ticks that were run again.
    pub ticks: u64,
    /// Ticks with a different answer.
    pub differences: u64,
    /// Whether the file ends early.
    pub cut_off: bool,
    /// Ticks that the recorder had to omit.
    pub lost_ticks: u64,
    /// Results per robot.
    pub robots: Vec<RobotReplay>,
}

/// Result of the replay of one robot.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct RobotReplay {
    /// Its name.
    pub name: String,
    /// Ticks that were run again.
    pub ticks: u64,
    /// Time of the last tick that was run again, s.
    pub until_s: f64,
    /// Ticks that were not run again, as a tick before them is missing.
    pub skipped: u64,
    /// Ticks with a different answer.
    pub differences: u64,
    /// The first difference.
    pub first: Option<Difference>,
}

/// A tick whose answer differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Its time, s.
    pub t_s: f64,
    /// Sequence number of the tick.
    pub sequence: u64,
    /// The part that differs: `override`, `outputs` or `reason`.
    pub what: &'static str,
    /// The recorded override.
    pub recorded: f64,
    /// The override of the replay.
    pub replayed: f64,
}
