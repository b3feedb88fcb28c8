//! Sizes of the crates: files, lines, public items, and lengths of files and functions.

use std::path::{Path, PathBuf};

use xtask::crates;

use crate::functions::functions;

/// Counts for one crate, or for all.
#[derive(Debug, Default)]
struct Size {
    /// Lines of each file below `src`.
    files: Vec<usize>,
    /// Lines of each function, its closing brace included.
    functions: Vec<usize>,
    public: usize,
    /// Lines below `tests`, `examples` and `benches`.
    test_lines: usize,
}

impl Size {
    fn add(&mut self, text: &str) {
        self.files.push(text.lines().count());
        self.public += text.lines().filter(|line| is_public(line)).count();
        self.functions.extend(functions(text).iter().map(|function| function.lines));
    }

    fn join(&mut self, other: &Self) {
        self.files.extend(&other.files);
        self.functions.extend(&other.functions);
        self.public += other.public;
        self.test_lines += other.test_lines;
    }

    fn row(&self, name: &str) -> String {
        let [files, functions] = [&self.files, &self.functions].map(|lengths| {
            let [p50, p90, most] = spread(lengths);
            format!("{p50:>4} {p90:>4} {most:>4}")
        });
        let lines: usize = self.files.iter().sum();
        let (count, public, tests) = (self.files.len(), self.public, self.test_lines);
        format!("{name:<12} {count:>5} {lines:>6} {tests:>6} {public:>6}   {files}   {functions}")
    }
}

/// Prints the sizes of the crates of the workspace at `root`.
pub fn run(root: &Path) -> Result<(), String> {
    let mut crates: Vec<PathBuf> = crates::find(root)?.into_iter().map(|found| found.folder).collect();
    crates.extend(["devtools", "xtask"].map(|name| root.join(name)).into_iter().filter(|path| path.is_dir()));
    println!(
        "{:<12} {:>5} {:>6} {:>6} {:>6}   {:>14}   {:>14}",
        "", "", "", "", "public", "lines of files", "of functions"
    );
    println!(
        "{:<12} {:>5} {:>6} {:>6} {:>6}   {:>4} {:>4} {:>4}   {:>4} {:>4} {:>4}",
        "crate", "files", "lines", "tests", "items", "p50", "p90", "max", "p50", "p90", "max"
    );
    let mut all = Size::default();
    for folder in crates {
        let mut size = Size::default();
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        each_source(&folder.join("src"), &mut |text| size.add(text))?;
        for tests in ["tests", "examples", "benches"] {
            each_source(&folder.join(tests), &mut |text| size.test_lines += text.lines().count())?;
        }
        println!("{}", size.row(&name));
        all.join(&size);
    }
    println!("{}", all.row("all"));
    Ok(())
}

fn each_source(folder: &Path, see: &mut impl FnMut(&str)) -> Result<(), String> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Ok(()) };
    for path in entries.flatten().map(|entry| entry.path()) {
        if path.is_dir() {
            each_source(&path, see)?;
        } else if path.extension().is_some_and(|e| e == "rs") {
            see(&std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?);
        }
    }
    Ok(())
}

fn is_public(line: &str) -> bool {
    const ITEMS: [&str; 9] = ["fn", "const", "static", "struct", "enum", "union", "trait", "type", "unsafe"];
    let rest = line.trim_start().strip_prefix("pub ");
    rest.and_then(|rest| rest.split_whitespace().next()).is_some_and(|word| ITEMS.contains(&word))
}

/// Returns median, 90th percentile and maximum.
fn spread(lengths: &[usize]) -> [usize; 3] {
    let mut sorted = lengths.to_vec();
    sorted.sort_unstable();
    let at = |share: usize| sorted.get((sorted.len().saturating_sub(1) * share).div_ceil(100)).copied().unwrap_or(0);
    [at(50), at(90), at(100)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn public_items_are_those_of_the_interface() {
        let lines = ["pub fn a()", "    pub struct B", "pub(crate) fn c()", "pub use d;", "pub e: u8,", "pub const F"];
        assert_eq!(lines.map(is_public), [true, true, false, false, false, true]);
    }

    #[test]
    fn the_spread_of_a_hundred_numbers() {
        assert_eq!(spread(&(0..=100).collect::<Vec<_>>()), [50, 90, 100]);
        assert_eq!(spread(&[]), [0, 0, 0]);
    }
}
