//! Duration of each unit in its last run, so that the longest start first.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use xtask::shell::target_folder;

/// Units of more than three seconds on two cores, for the first run in a target folder.
const FIRST: &str = include_str!("first-times.txt");

/// Last durations, seconds by unit.
#[derive(Debug, Default)]
pub struct Times {
    file: PathBuf,
    seconds: HashMap<String, f64>,
}

impl Times {
    /// Reads the durations of the last run; a unit that did not run then has its duration from the list.
    pub fn read(root: &Path) -> Self {
        let file = target_folder(root).join("test-times.txt");
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let entry = |line: &str| {
            let (name, seconds) = line.split_once(' ')?;
            Some((name.to_owned(), seconds.trim().parse().ok()?))
        };
        Self { file, seconds: FIRST.lines().chain(text.lines()).filter_map(entry).collect() }
    }

    /// Duration in the last run, s; 0 for a unit that is neither in it nor in the list.
    pub fn expected(&self, unit: &str) -> f64 {
        self.seconds.get(unit).copied().unwrap_or(0.0)
    }

    /// Records the duration of a unit.
    pub fn keep(&mut self, unit: &str, time: Duration) {
        self.seconds.insert(unit.to_owned(), time.as_secs_f64());
    }

    /// Writes the file. The durations only choose an order, so a failed write is reported but is not an error.
    pub fn write(&self) {
        let mut lines: Vec<String> = self.seconds.iter().map(|(name, s)| format!("{name} {s:.2}")).collect();
        lines.sort();
        if let Err(e) = std::fs::write(&self.file, lines.join("\n") + "\n") {
            println!("{}: {e}; the next run does not know which tests are long", self.file.display());
        }
    }
}
