//! The table of keys by keys.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::{Coverage, known_keys};

/// Number of the least covered pairs that the summary names.
const NAMED: usize = 5;

impl Coverage {
    /// Writes the number of files that have two keys as a table: a row and a column per key. Returns its file.
    pub fn write_table(&self, folder: &Path) -> Result<PathBuf, String> {
        let names: Vec<String> = known_keys().iter().map(|(title, name)| quoted(title, name)).collect();
        let mut text = format!("key,{}\n", names.join(","));
        for (row, name) in names.iter().enumerate() {
            text += name;
            for column in 0..names.len() {
                let _ = write!(text, ",{}", self.pair(row, column));
            }
            text.push('\n');
        }
        let file = folder.join("fuzz-keys.csv");
        std::fs::write(&file, text).map_err(|e| format!("{}: {e}", file.display()))?;
        Ok(file)
    }

    fn pair(&self, a: usize, b: usize) -> usize {
        self.pairs.get(&(a.min(b), a.max(b))).copied().unwrap_or(0)
    }

    /// Number of pairs of keys that files have together, and of all pairs of keys that files have.
    pub fn pairs_of_keys(&self) -> (usize, usize) {
        let tried = (0..known_keys().len()).filter(|key| self.with(*key) > 0).count();
        let seen = self.pairs.keys().filter(|(a, b)| a != b).count();
        (seen, tried * tried.saturating_sub(1) / 2)
    }

    /// The pairs of keys seen, and the pairs of frequent keys that no file has together.
    pub fn summary(&self) -> String {
        let keys = known_keys();
        let mut unseen: Vec<(usize, usize, usize)> = Vec::new();
        for a in 0..keys.len() {
            for b in a + 1..keys.len() {
                if self.pair(a, b) == 0 && self.with(a).min(self.with(b)) > 0 {
                    unseen.push((self.with(a).min(self.with(b)), a, b));
                }
            }
        }
        unseen.sort_unstable_by(|x, y| y.cmp(x));
        let name = |key: usize| format!("{}: {}", keys[key].0, keys[key].1);
        let named = unseen.iter().take(NAMED).map(|(_, a, b)| format!("{} × {}", name(*a), name(*b)));
        let (seen, possible) = self.pairs_of_keys();
        format!(
            "{} of {} keys in {} cells, {seen} of {possible} pairs of them; most frequent keys that are never together: {}",
            (0..keys.len()).filter(|key| self.with(*key) > 0).count(),
            keys.len(),
            self.files,
            named.collect::<Vec<String>>().join("; ")
        )
    }
}

/// A name of a key as a cell of a CSV file.
fn quoted(title: &str, name: &str) -> String {
    format!("\"{title}: {name}\"")
}
