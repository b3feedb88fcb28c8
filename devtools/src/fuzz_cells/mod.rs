//! `cargo xtask fuzz cells`: runs random cells in simulated time, and checks them by an oracle that knows only the recording.

mod checked_run;
mod coverage;
pub mod generate;
mod oracle;
mod pictures;
mod random;
mod shrink;
pub mod spec;
mod summary;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use elbowroom_cell::Cell;

use coverage::{CellKeys, Coverage};
use generate::{Kind, Places};
use oracle::{Finding, Judged};
use pictures::PictureFolders;
use spec::CellSpec;
use summary::Summary;
use xtask::Failure;

/// A mesh for regions: a corner of two plates, 0.3 m wide, closed and not convex.
const CORNER: &str = include_str!("corner.obj");
/// A model of a robot with two joints, and the file of its joints.
const ARM: [(&str, &str); 2] = [("arm.wrl", include_str!("arm.wrl")), ("arm_axes.toml", include_str!("arm_axes.toml"))];
/// Largest number of failing cells written as files, per kind.
const WRITTEN: usize = 20;

/// Stack size of a thread that runs cells, bytes.
const STACK_BYTES: usize = 8 << 20;

/// Seed of the cells in the test suite; their number depends on the kind.
const SUITE_SEED: u64 = 3;

/// Options of `fuzz cells`.
#[derive(Debug, PartialEq)]
pub struct Options {
    /// Cells per kind; by default as many as in the test suite.
    count: Option<usize>,
    seed: u64,
    kinds: Vec<Kind>,
    json: bool,
    /// Only this case of each kind.
    case: Option<u64>,
    replay: Option<PathBuf>,
    shrinks: bool,
    /// Whether to print which keys the cells have.
    keys: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            count: Some(1000),
            seed: 1,
            kinds: Kind::ALL.to_vec(),
            json: false,
            case: None,
            replay: None,
            shrinks: true,
            keys: false,
        }
    }
}

impl Options {
    /// Reads the words after `fuzz cells`.
    pub fn parse(words: &[&str]) -> Result<Self, String> {
        let mut options = Self::default();
        let mut words = words.iter();
        while let Some(word) = words.next() {
            let mut value = || words.next().copied().ok_or_else(|| format!("`{word}` needs a value"));
            match *word {
                "--count" => options.count = Some(xtask::call::count(word, value()?)?),
                "--seed" => options.seed = number(word, value()?)?,
                "--case" => options.case = Some(number(word, value()?)?),
                "--kind" => options.kinds = kinds(value()?)?,
                "--replay" => options.replay = Some(PathBuf::from(value()?)),
                "--json" => options.json = true,
                "--keys" => options.keys = true,
                "--no-shrink" => options.shrinks = false,
                other => return Err(format!("`fuzz cells` does not know `{other}`")),
            }
        }
        Ok(options)
    }
}

fn number(option: &str, value: &str) -> Result<u64, String> {
    value.parse().map_err(|_| format!("`{option} {value}`: write a whole number"))
}

fn kinds(word: &str) -> Result<Vec<Kind>, String> {
    if word == "all" {
        return Ok(Kind::ALL.to_vec());
    }
    let kind = Kind::ALL.into_iter().find(|k| k.name() == word);
    let names = Kind::ALL.map(Kind::name).join(", ");
    kind.map(|k| vec![k]).ok_or_else(|| format!("`--kind {word}`: write {names} or all"))
}

/// Runs the cells, or one file, and prints the findings; fails if there are any.
pub fn run(root: &Path, options: &Options) -> Result<(), Failure> {
    let cells = write_cell_files(root)?;
    if let Some(file) = &options.replay {
        return replay(file);
    }
    let data = xtask::call::data_folder(root, None);
    let places = Places { cells: &cells, root, data: data.is_dir().then_some(&data) };
    let summaries: Vec<Summary> = options.kinds.iter().map(|kind| fuzz(*kind, options, &places)).collect();
    let mut coverage = Coverage::default();
    for summary in &summaries {
        coverage.merge(&summary.coverage);
    }
    let table = options.keys.then(|| coverage.write_table(&root.join("target"))).transpose()?;
    if options.json {
        let keys = table.as_ref().map(|file| (&coverage, file.as_path()));
        println!("{}", summary::json(options.seed, &summaries, keys));
    } else {
        summary::print(&summaries);
        if let Some(file) = &table {
            coverage.print();
            println!("{}\n{}", coverage.summary(), file.display());
        }
    }
    if options.count.is_none() {
        coverage.check().map_err(Failure::Check)?;
        let mut judged = Judged::default();
        for summary in &summaries {
            judged.add(&summary.judged);
        }
        if !judged.has_all() {
            return Err(Failure::Check(format!("the oracle judges nothing of a kind of sensor: {judged:?}")));
        }
    }
    let failed: usize = summaries.iter().map(Summary::failed).sum();
    if failed == 0 { Ok(()) } else { Err(Failure::Check(format!("{failed} cells failed: {}", cells.display()))) }
}

/// Makes the folder of the cells, with the files that they name.
pub fn write_cell_files(root: &Path) -> Result<PathBuf, String> {
    let cells = root.join("target/fuzz-cells");
    let files = ARM.into_iter().chain([("corner.obj", CORNER), ("rules.toml", elbowroom_avoidance::DEFAULT_RULES)]);
    let write = || files.into_iter().try_for_each(|(name, text)| std::fs::write(cells.join(name), text));
    let written = std::fs::create_dir_all(&cells).and_then(|()| write());
    written.map_err(|e| format!("{}: {e}", cells.display()))?;
    Ok(cells)
}

/// Checks the cells of every kind that the test suite runs, always the same ones.
pub fn check(root: &Path) -> Result<(), String> {
    let options = Options { count: None, seed: SUITE_SEED, ..Options::default() };
    run(root, &options).map_err(|failure| match failure {
        Failure::Check(message) | Failure::Usage(message) => message,
    })
}

/// Runs a cell file and checks it by the oracle.
fn replay(file: &Path) -> Result<(), Failure> {
    let text = std::fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let faults = spec::read_faults(&text)?;
    let cell = Cell::parse(file, &text).map_err(|e| e.to_string())?;
    let repeat = spec::read_repeat(&text)?;
    let findings =
        checked_run::run(&cell, &text, &faults, repeat).map_err(|e| format!("{}: {e}", file.display()))?.findings.list;
    for finding in &findings {
        println!("{}", summary::in_words(finding, &cell));
    }
    if findings.is_empty() {
        println!("{}: nothing found", file.display());
        return Ok(());
    }
    Err(Failure::Check(format!("{} findings", findings.len())))
}

/// Runs the cases on all cores; the findings do not depend on their number.
fn fuzz(kind: Kind, options: &Options, places: &Places<'_>) -> Summary {
    let mut summary = Summary::new(kind.name());
    let begin = Instant::now();
    let count = options.count.unwrap_or(kind.suite_cells());
    let (first, end) = options.case.map_or((0, count as u64), |case| (case, case + 1));
    let spec = |case| generate::cell(kind, &mut kind.random(options.seed, case), places);
    let next = AtomicU64::new(first);
    std::thread::scope(|threads| {
        let (send, results) = mpsc::channel();
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            let (send, spec, next) = (send.clone(), &spec, &next);
            let work = move || {
                loop {
                    let case = next.fetch_add(1, Ordering::Relaxed);
                    if case >= end {
                        return;
                    }
                    let spec = spec(case);
                    let run = checked_run::run_spec(&spec, places).map(|run| (run, CellKeys::of(&spec.to_toml())));
                    if send.send((case, run)).is_err() {
                        return;
                    }
                }
            };
            // As large as a main thread's stack: a robot with avoidance is built on the stack.
            let worker = std::thread::Builder::new().stack_size(STACK_BYTES).spawn_scoped(threads, work);
            worker.expect("the system has no more threads");
        }
        drop(send);
        let mut printed = Instant::now();
        for (case, result) in results {
            match result {
                Ok((run, keys)) => {
                    if let Some(finding) = run.findings.list.first() {
                        report(finding, &spec(case), (kind, case), options, places, &mut summary);
                    }
                    summary.add(&run);
                    summary.coverage.add(&keys);
                }
                Err(e) => summary.refuse(case, &e),
            }
            if printed.elapsed() > Duration::from_secs(2) && !options.json {
                printed = Instant::now();
                eprint!("\r{}", summary.progress());
            }
        }
    });
    summary.files.sort();
    summary.took = begin.elapsed();
    if !options.json {
        eprintln!("\r{}", summary.progress());
    }
    summary
}

/// Shrinks the cell while it fails in the same way, and writes it.
fn report(
    finding: &Finding,
    spec: &CellSpec,
    (kind, case): (Kind, u64),
    options: &Options,
    places: &Places<'_>,
    summary: &mut Summary,
) {
    if summary.files.len() >= WRITTEN {
        return;
    }
    let fails = |s: &CellSpec| {
        let run = checked_run::run_spec(s, places).ok()?;
        run.findings.list.iter().find(|f| std::mem::discriminant(*f) == std::mem::discriminant(finding)).cloned()
    };
    let (small, finding) =
        if options.shrinks { shrink::smallest(spec, finding, &fails) } else { (spec.clone(), finding.clone()) };
    let text = small.to_toml();
    let file = places.cells.join(format!("{}-{}-{case}.toml", kind.name(), options.seed));
    let Ok(cell) = small.parse(places.cells) else { return };
    let pictures = PictureFolders::write(&small, places.cells).map(PictureFolders::keep);
    let words = summary::in_words(&finding, &cell);
    let found_by = format!("cargo xtask fuzz cells --kind {} --seed {} --case {case}", kind.name(), options.seed);
    // What was written into a recording, or shown to a sensor, is known only to the generator.
    let again = match finding {
        Finding::OffRecording { .. }
        | Finding::TouchedSeen { .. }
        | Finding::MovedUnseen { .. }
        | Finding::HeldForNothing { .. } => "the same",
        _ => "cargo xtask fuzz cells --replay FILE, or elbowroom run FILE",
    };
    let head = format!("# {words}\n# Found by: {found_by}\n# Again: {again}\n");
    let written = std::fs::write(&file, head + &text).and_then(|()| small.write_files(places.cells));
    let problem = written.map_err(|e| e.to_string()).and(pictures).err();
    summary.files.push((file, words + &problem.map(|why| format!(" (not written: {why})")).unwrap_or_default()));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_read_and_nonsense_is_refused() {
        let options = Options::parse(&["--count", "7", "--seed", "3", "--kind", "exchange", "--json"]).unwrap();
        assert_eq!((options.count, options.seed, options.json), (Some(7), 3, true));
        assert_eq!(options.kinds, [Kind::Exchange]);
        assert!(Options::parse(&["--kind", "all"]).unwrap().kinds.len() == Kind::ALL.len());
        assert!(Options::parse(&["--kind", "nothing"]).is_err());
        assert!(Options::parse(&["--count"]).is_err());
        assert!(Options::parse(&["--fast"]).is_err());
    }

    #[test]
    fn a_case_is_the_same_cell_every_time() {
        let root = crate::workspace_root().unwrap();
        let cells = root.join("target/fuzz-cells");
        let places = Places { cells: &cells, root: &root, data: None };
        for kind in Kind::ALL {
            let text = |case| generate::cell(kind, &mut kind.random(5, case), &places).to_toml();
            assert_eq!(text(3), text(3));
            assert_ne!(text(3), text(4));
        }
    }
}
