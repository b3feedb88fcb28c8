//! Recordings that robots play: CSV files beside the cell.

use std::fmt::Write as _;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::Path;

/// Rows of time (s) and joint values (rad or m).
#[derive(Debug, Clone)]
pub struct RecordingSpec {
    pub rows: Vec<(f64, Vec<f64>)>,
}

impl RecordingSpec {
    /// Returns the name of the file, made from its contents, so that cells do not share it.
    pub fn file_name(&self) -> String {
        let mut hasher = DefaultHasher::new();
        self.csv().hash(&mut hasher);
        format!("recording-{:016x}.csv", hasher.finish())
    }

    pub fn csv(&self) -> String {
        let joints = self.rows.first().map_or(0, |(_, q)| q.len());
        let mut text = String::from("t_s");
        for joint in 1..=joints {
            let _ = write!(text, ",joint_{joint}");
        }
        for (t_s, q) in &self.rows {
            let _ = write!(text, "\n{t_s}");
            for value in q {
                let _ = write!(text, ",{value}");
            }
        }
        text + "\n"
    }

    pub(super) fn write_file(&self, folder: &Path) -> std::io::Result<()> {
        std::fs::write(folder.join(self.file_name()), self.csv())
    }
}
