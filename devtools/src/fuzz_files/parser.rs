//! Mutation fuzzing of one reader: `cargo xtask fuzz parser PARSER SECONDS [DIR [SEED]]`.
//!
//! PARSER is one of stl obj dae gltf ply off 3ds wrl urdf srdf scene yaml mesh. Damages the built-in samples and the files of DIR (those
//! of the parser's kind below 64 KiB), and counts panics, readings slower than 2 s, and results too large for the
//! input. Limit the memory from outside (`ulimit -v`). An error if anything was found; the input is kept in the temporary
//! directory.

#[path = "../../../crates/world/formats/tests/common/corpus.rs"]
mod corpus;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use xtask::Failure;

use super::words::{SEED, number};
use corpus::{PARSERS, Xorshift, mutate, samples};

const LARGEST_SEED: u64 = 64 * 1024;
const SLOW: Duration = Duration::from_secs(2);

/// Options of `fuzz parser`.
pub struct Options {
    parser: &'static str,
    seconds: u64,
    directory: Option<PathBuf>,
    seed: u64,
}

impl Options {
    /// Reads `PARSER SECONDS [DIR [SEED]]`.
    pub fn parse(words: &[&str]) -> Result<Self, String> {
        let parser = PARSERS.into_iter().find(|parser| words.first() == Some(parser));
        Ok(Self {
            parser: parser.ok_or_else(|| format!("PARSER is one of {}", PARSERS.join(" ")))?,
            seconds: number("SECONDS", words.get(1), None)?,
            directory: words.get(2).map(PathBuf::from),
            seed: number("SEED", words.get(3), Some(SEED))?,
        })
    }
}

/// Damages files and reads them until the time is over.
pub fn run(options: &Options) -> Result<(), Failure> {
    let parser = options.parser;
    let mut corpus = samples(parser);
    if let Some(directory) = &options.directory {
        collect(directory, parser, &mut corpus);
    }
    std::panic::set_hook(Box::new(|_| {}));
    let report = fuzz(parser, Duration::from_secs(options.seconds), &corpus, Xorshift(options.seed));
    eprintln!("{parser}: {} files, {report}", corpus.len());
    if report.findings == 0 { Ok(()) } else { Err(Failure::Check(format!("{} findings", report.findings))) }
}

fn collect(directory: &Path, parser: &str, corpus: &mut Vec<Vec<u8>>) {
    for entry in std::fs::read_dir(directory).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, parser, corpus);
        } else if is_of_kind(&path, parser) && entry.metadata().is_ok_and(|m| m.len() <= LARGEST_SEED) {
            corpus.extend(std::fs::read(&path));
        }
    }
}

fn is_of_kind(path: &Path, parser: &str) -> bool {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    extension == parser
        || (parser == "gltf" && extension == "glb")
        || (parser == "mesh" && PARSERS.contains(&extension.as_str()))
}

#[derive(Default)]
struct Report {
    executions: u64,
    valid: u64,
    findings: u64,
    slowest: Duration,
    largest: usize,
}

impl std::fmt::Display for Report {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { executions, valid, findings, slowest, largest } = self;
        write!(
            f,
            "{executions} executions, {valid} of them loaded, {findings} findings, slowest {slowest:.1?}, largest result {largest} bytes"
        )
    }
}

fn fuzz(parser: &str, time: Duration, corpus: &[Vec<u8>], mut random: Xorshift) -> Report {
    let mut report = Report::default();
    let end = Instant::now() + time;
    while Instant::now() < end {
        let mut bytes = corpus[random.below(corpus.len())].clone();
        let other = random.below(corpus.len());
        mutate(&mut random, &mut bytes, &corpus[other]);
        let start = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| corpus::run(parser, &bytes)));
        let elapsed = start.elapsed();
        report.executions += 1;
        report.slowest = report.slowest.max(elapsed);
        let finding = match outcome {
            Err(_) => Some("panic"),
            Ok(Ok(size)) if size > (1 << 20) + 200 * bytes.len() => Some("outsized"),
            Ok(_) if elapsed > SLOW => Some("slow"),
            Ok(result) => {
                report.valid += u64::from(result.is_ok());
                report.largest = report.largest.max(result.unwrap_or(0));
                None
            }
        };
        if let Some(kind) = finding {
            report.findings += 1;
            let path: PathBuf = std::env::temp_dir().join(format!("fuzz-{parser}-{kind}-{}", report.findings));
            drop(std::fs::write(&path, &bytes));
            eprintln!("{parser}: {kind}: {}", path.display());
        }
    }
    report
}
