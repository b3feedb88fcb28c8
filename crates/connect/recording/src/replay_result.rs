//! What a replay found.

use serde::Serialize;

/// What a replay found.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Replay {
    /// The cell.
    pub cell: String,
    /// Checksum of its configuration.
    pub checksum: String,
    /// Messages in the recording.
    pub messages: u64,
    /// Ticks that were run again.
    pub ticks: u64,
    /// Ticks with another answer.
    pub differences: u64,
    /// The file ends before its end was written.
    pub cut_off: bool,
    /// Ticks that the recorder had to leave out.
    pub lost_ticks: u64,
    /// Per robot.
    pub robots: Vec<RobotReplay>,
}

/// What the replay of a robot found.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct RobotReplay {
    /// Its name.
    pub name: String,
    /// Ticks that were run again.
    pub ticks: u64,
    /// Time of the last of them, s.
    pub until_s: f64,
    /// Ticks that were not, as one before them is missing.
    pub skipped: u64,
    /// Ticks with another answer.
    pub differences: u64,
    /// The first of them.
    pub first: Option<Difference>,
}

/// A tick whose answer differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Its time, s.
    pub t_s: f64,
    /// Its number.
    pub sequence: u64,
    /// What differs: `override`, `outputs` or `reason`.
    pub what: &'static str,
    /// The recorded override.
    pub recorded: f64,
    /// The override of the replay.
    pub replayed: f64,
}
