//! Which units passed with the very program and files that are here now: they need not run again, as in `go test`.
//!
//! A test may read any file of the repository and of the real data, so a change in one of them, but for documents and for the sources
//! that are compiled, makes every unit run. Python, the browser and the C compiler are not looked at.

use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::ffi::OsStr;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};

use xtask::{call, shell};

use super::programs::Program;
use super::units::Unit;

/// A unit that passed: with what, and how many tests it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Pass {
    stamp: u64,
    tests: usize,
}

/// The units that passed when they ran last.
#[derive(Debug, Default)]
pub struct Passes {
    file: PathBuf,
    /// What each program is and may read now; nothing for a program whose units always run.
    stamps: Vec<Option<u64>>,
    known: HashMap<String, Pass>,
}

impl Passes {
    /// Reads what passed in this target folder, and looks at what there is now.
    pub fn read(root: &Path, programs: &[Program], env: &[(&str, &str)]) -> Self {
        let file = shell::target_folder(root).join("test-passes.txt");
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let surroundings = surroundings(root, env);
        let crates = root.join("crates");
        let stamp = |program: &Program| {
            // The other programs read the sources.
            let surroundings = surroundings.filter(|_| program.folder.starts_with(&crates))?;
            let mut hasher = DefaultHasher::new();
            surroundings.hash(&mut hasher);
            look(&program.executable, &mut hasher);
            Some(hasher.finish())
        };
        Self { file, stamps: programs.iter().map(stamp).collect(), known: text.lines().filter_map(entry).collect() }
    }

    /// How many tests of the unit passed, if neither its program nor a file that it may read has changed since.
    pub fn of(&self, unit: &Unit) -> Option<usize> {
        let pass = self.known.get(&unit.name)?;
        (self.stamps[unit.program] == Some(pass.stamp)).then_some(pass.tests)
    }

    /// Keeps how a unit ended: `passed` is how many tests it has if all of them ran and passed.
    pub fn keep(&mut self, unit: &Unit, passed: Option<usize>) {
        self.known.remove(&unit.name);
        if let (Some(tests), Some(stamp)) = (passed, self.stamps.get(unit.program).copied().flatten()) {
            self.known.insert(unit.name.clone(), Pass { stamp, tests });
        }
    }

    /// Writes the file. Without it all units run next time, so a failed write is reported and is not an error.
    pub fn write(&self) {
        let line = |(name, Pass { stamp, tests }): (&String, &Pass)| format!("{name} {stamp:x} {tests}");
        let mut lines: Vec<String> = self.known.iter().map(line).collect();
        lines.sort();
        if let Err(e) = std::fs::write(&self.file, lines.join("\n") + "\n") {
            println!("{}: {e}; all tests will run again", self.file.display());
        }
    }
}

/// A line of the file.
fn entry(line: &str) -> Option<(String, Pass)> {
    let mut words = line.split(' ');
    let (name, stamp, tests) = (words.next()?, words.next()?, words.next()?);
    Some((name.to_owned(), Pass { stamp: u64::from_str_radix(stamp, 16).ok()?, tests: tests.parse().ok()? }))
}

/// What tests may read besides their program: settings, files of the repository, the real data. Nothing without `git`.
fn surroundings(root: &Path, env: &[(&str, &str)]) -> Option<u64> {
    let mut hasher = DefaultHasher::new();
    env.hash(&mut hasher);
    let is_ours = |name: &OsStr| name.to_str().is_some_and(|name| name.starts_with("ELBOWROOM_"));
    let mut settings: Vec<_> = std::env::vars_os().filter(|(name, _)| is_ours(name)).collect();
    settings.sort();
    settings.hash(&mut hasher);
    let files = shell::output(root, "git", &["ls-files", "-z", "--cached", "--others", "--exclude-standard"]).ok()?;
    let is_read = |file: &&str| match Path::new(file).extension().and_then(OsStr::to_str) {
        Some("rs") => !file.starts_with("crates/"),
        Some("md") => false,
        _ => true,
    };
    files.split_terminator('\0').filter(is_read).for_each(|file| look(&root.join(file), &mut hasher));
    look_into(&call::data_folder(root, None), &mut hasher);
    Some(hasher.finish())
}

/// A file by its place, length and time: cargo, too, trusts these.
fn look(file: &Path, hasher: &mut DefaultHasher) {
    let found = std::fs::metadata(file).ok();
    (file, found.map(|found| (found.len(), found.modified().ok()))).hash(hasher);
}

fn look_into(folder: &Path, hasher: &mut DefaultHasher) {
    let mut entries: Vec<_> = std::fs::read_dir(folder).into_iter().flatten().flatten().collect();
    entries.sort_by_key(std::fs::DirEntry::path);
    for entry in entries {
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            look_into(&entry.path(), hasher);
        } else {
            look(&entry.path(), hasher);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn program(executable: &Path, folder: &str) -> Program {
        Program { name: "a/lib".into(), executable: executable.into(), folder: folder.into(), has_harness: true }
    }

    #[test]
    fn a_unit_that_passed_runs_again_once_its_program_or_a_setting_changes() {
        let root = xtask::call::workspace_root().unwrap();
        let executable = std::env::temp_dir().join(format!("passes-{}", std::process::id()));
        let unit = Unit { name: "a/lib".into(), program: 0, tests: Vec::new() };
        let here = [program(&executable, &root.join("crates/base/robot").to_string_lossy())];
        let look_again = |kept: &Passes, env| {
            let now = Passes::read(&root, &here, env);
            Passes { stamps: now.stamps, known: kept.known.clone(), ..Passes::default() }.of(&unit)
        };
        std::fs::write(&executable, "one").unwrap();
        let mut passes = Passes::read(&root, &here, &[]);
        passes.keep(&unit, Some(3));
        assert_eq!((look_again(&passes, &[]), look_again(&passes, &[("A", "b")])), (Some(3), None));
        std::fs::write(&executable, "other").unwrap();
        assert_eq!(look_again(&passes, &[]), None);
        std::fs::remove_file(&executable).unwrap();
        passes.keep(&unit, None);
        assert_eq!(passes.of(&unit), None);
    }

    #[test]
    fn programs_that_read_the_sources_always_run() {
        let root = xtask::call::workspace_root().unwrap();
        let passes =
            Passes::read(&root, &[program(&root.join("Cargo.toml"), &root.join("xtask").to_string_lossy())], &[]);
        assert_eq!(passes.stamps, [None]);
    }

    #[test]
    fn a_line_of_the_file_is_read_and_another_is_not() {
        assert_eq!(entry("a/main/b 1f 7"), Some(("a/main/b".into(), Pass { stamp: 31, tests: 7 })));
        assert_eq!(entry("a/main/b 1f"), None);
    }
}
