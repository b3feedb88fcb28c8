//! Units that passed with exactly the present program and files: they need not run again, as in `go test`.
//!
//! A test may read any file of the repository and of the real data, so a change in one of them makes every unit run,
//! except for documents and for sources that are compiled. Changes of Python, the browser and the C compiler are not
//! noticed.

use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::ffi::OsStr;
use std::hash::{Hash, Hasher};
use std::path::{Path, PathBuf};

use xtask::{call, shell};

use super::counts::Counts;
use super::programs::Program;
use super::units::Unit;

/// The crate below `crates` whose tests read the folder `python`.
const READS_PACKAGE: &str = "front/python";

/// A unit that passed: the hash of its program and files, and the numbers of its tests. Tests that the program ignores
/// are ignored until it changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Pass {
    stamp: u64,
    passed: usize,
    ignored: usize,
}

/// Units that passed in their last run.
#[derive(Debug, Default)]
pub struct Passes {
    file: PathBuf,
    /// Hash of each program and of the files that it may read; `None` for a program whose units always run.
    stamps: Vec<Option<u64>>,
    known: HashMap<String, Pass>,
}

impl Passes {
    /// Reads the passes of this target folder, and hashes the present files. The file is removed until it is written
    /// again: an interrupted run leaves no passes that it may have disproved.
    pub fn read(root: &Path, programs: &[Program], env: &[(&str, &str)]) -> Self {
        Self::of_file(shell::target_folder(root).join("test-passes.txt"), root, programs, env)
    }

    fn of_file(file: PathBuf, root: &Path, programs: &[Program], env: &[(&str, &str)]) -> Self {
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let _ = std::fs::remove_file(&file);
        let surroundings = surroundings(root, env);
        let crates = root.join("crates");
        let stamp = |program: &Program| {
            let reads_package = program.folder.starts_with(crates.join(READS_PACKAGE));
            // Programs outside `crates` read the sources.
            let surroundings = surroundings.as_ref().filter(|_| program.folder.starts_with(&crates))?;
            let mut hasher = DefaultHasher::new();
            surroundings.all.hash(&mut hasher);
            reads_package.then_some(surroundings.package).hash(&mut hasher);
            look(&program.executable, &mut hasher);
            program.started.iter().for_each(|started| look(started, &mut hasher));
            Some(hasher.finish())
        };
        Self { file, stamps: programs.iter().map(stamp).collect(), known: text.lines().filter_map(entry).collect() }
    }

    /// Counts of the unit's tests, if it passed and neither its program nor a file that it may read has changed since.
    pub fn of(&self, unit: &Unit) -> Option<Counts> {
        let Pass { stamp, passed, ignored } = *self.known.get(&unit.name)?;
        (self.stamps[unit.program] == Some(stamp)).then_some(Counts { passed, failed: 0, ignored })
    }

    /// Records the result of a unit: `counts` are those of its tests if none failed, and none lacked its data.
    pub fn keep(&mut self, unit: &Unit, counts: Option<Counts>) {
        self.known.remove(&unit.name);
        if let (Some(Counts { passed, ignored, .. }), Some(stamp)) =
            (counts, self.stamps.get(unit.program).copied().flatten())
        {
            self.known.insert(unit.name.clone(), Pass { stamp, passed, ignored });
        }
    }

    /// Writes the file. Without it all units run next time, so a failed write is reported but is not an error.
    pub fn write(&self) {
        let line =
            |(name, Pass { stamp, passed, ignored }): (&String, &Pass)| format!("{name} {stamp:x} {passed} {ignored}");
        let mut lines: Vec<String> = self.known.iter().map(line).collect();
        lines.sort();
        if let Err(e) = std::fs::write(&self.file, lines.join("\n") + "\n") {
            println!("{}: {e}; all tests will run again", self.file.display());
        }
    }
}

/// Parses a line of the file.
fn entry(line: &str) -> Option<(String, Pass)> {
    let mut words = line.split(' ');
    let (name, stamp) = (words.next()?, u64::from_str_radix(words.next()?, 16).ok()?);
    let mut number = || words.next()?.parse().ok();
    Some((name.to_owned(), Pass { stamp, passed: number()?, ignored: number()? }))
}

/// Hashes of what tests may read besides their program.
struct Surroundings {
    /// Settings, files of the repository, the real data.
    all: u64,
    /// Files of the Python package, which only its own tests read.
    package: u64,
}

/// Hashes what tests may read besides their program. `None` without `git`.
fn surroundings(root: &Path, env: &[(&str, &str)]) -> Option<Surroundings> {
    let (mut all, mut package) = (DefaultHasher::new(), DefaultHasher::new());
    env.hash(&mut all);
    let is_ours = |name: &OsStr| name.to_str().is_some_and(|name| name.starts_with("ELBOWROOM_"));
    let mut settings: Vec<_> = std::env::vars_os().filter(|(name, _)| is_ours(name)).collect();
    settings.sort();
    settings.hash(&mut all);
    let files = shell::output(root, "git", &["ls-files", "-z", "--cached", "--others", "--exclude-standard"]).ok()?;
    let is_read = |file: &&str| {
        let ending = Path::new(file).extension().and_then(OsStr::to_str);
        !matches!(ending, Some("rs" | "md"))
    };
    for file in files.split_terminator('\0').filter(is_read) {
        look(&root.join(file), if file.starts_with("python/") { &mut package } else { &mut all });
    }
    look_into(&call::data_folder(root, None), &mut all);
    Some(Surroundings { all: all.finish(), package: package.finish() })
}

/// Hashes a file's path, length and time, which cargo trusts too.
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
        let started = vec![executable.with_extension("started")];
        Program {
            name: "a/main".into(),
            executable: executable.into(),
            started,
            folder: folder.into(),
            has_harness: true,
        }
    }

    const PASSED: Counts = Counts { passed: 3, failed: 0, ignored: 1 };

    /// Makes a repository with a file that tests read.
    fn repository() -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        std::fs::create_dir_all(root.path().join("crates/a")).unwrap();
        std::fs::create_dir(root.path().join("target")).unwrap();
        std::fs::write(root.path().join(".gitignore"), "target\n").unwrap();
        std::fs::write(root.path().join("cell.toml"), "version = 1").unwrap();
        shell::output(root.path(), "git", &["init", "-q"]).unwrap();
        root
    }

    #[test]
    fn a_unit_that_passed_runs_again_once_its_program_or_what_it_starts_or_reads_changes() {
        let root = repository();
        let (root, executable) = (root.path(), root.path().join("target/main"));
        let unit = Unit { name: "a/main/b".into(), program: 0, tests: Vec::new() };
        let here = [program(&executable, &root.join("crates/a").to_string_lossy())];
        let passed_with = |env: &[(&str, &str)]| {
            let mut passes = Passes::of_file(root.join("target/passes"), root, &here, env);
            let before = passes.of(&unit);
            passes.keep(&unit, Some(PASSED));
            passes.write();
            before
        };
        std::fs::write(&executable, "one").unwrap();
        assert_eq!((passed_with(&[]), passed_with(&[])), (None, Some(PASSED)));
        assert_eq!((passed_with(&[("A", "b")]), passed_with(&[])), (None, None));
        for file in ["target/main", "target/main.started", "cell.toml"] {
            std::fs::write(root.join(file), "another text").unwrap();
            assert_eq!((passed_with(&[]), passed_with(&[])), (None, Some(PASSED)), "{file}");
        }
        // Sources are compiled into the program, and no test reads documents.
        for file in ["crates/a/lib.rs", "README.md"] {
            std::fs::write(root.join(file), "text").unwrap();
            assert_eq!(passed_with(&[]), Some(PASSED), "{file}");
        }
        // The unit fails now.
        let mut passes = Passes::of_file(root.join("target/passes"), root, &here, &[]);
        passes.keep(&unit, None);
        passes.write();
        assert_eq!(passed_with(&[]), None);
        // An interrupted run keeps nothing.
        drop(Passes::of_file(root.join("target/passes"), root, &here, &[]));
        assert_eq!(passed_with(&[]), None);
    }

    #[test]
    fn files_of_the_package_concern_its_own_tests() {
        let root = repository();
        let (root, executable) = (root.path(), root.path().join("target/main"));
        std::fs::write(&executable, "one").unwrap();
        std::fs::create_dir(root.join("python")).unwrap();
        let folders = ["crates/a", "crates/front/python"].map(|folder| root.join(folder));
        let programs = folders.map(|folder| program(&executable, &folder.to_string_lossy()));
        let stamps = || Passes::of_file(root.join("target/passes"), root, &programs, &[]).stamps;
        let before = stamps();
        std::fs::write(root.join("python/package.py"), "text").unwrap();
        let after = stamps();
        assert!(before[0].is_some() && before[0] == after[0] && before[1] != after[1], "{before:?} {after:?}");
    }

    #[test]
    fn programs_that_read_the_sources_always_run() {
        let root = repository();
        let here = [program(&root.path().join("cell.toml"), &root.path().join("xtask").to_string_lossy())];
        assert_eq!(Passes::of_file(root.path().join("target/passes"), root.path(), &here, &[]).stamps, [None]);
    }

    #[test]
    fn a_line_of_the_file_is_read_and_another_is_not() {
        assert_eq!(entry("a/main/b 1f 7 1"), Some(("a/main/b".into(), Pass { stamp: 31, passed: 7, ignored: 1 })));
        assert_eq!((entry("a/main/b 1f"), entry("a/main/b 1f 7")), (None, None));
    }
}
