//! Mutation fuzzing of one reader: `cargo run --release -p elbowroom-formats --example fuzz -- PARSER SECONDS [DIR [SEED]]`.
//!
//! PARSER is one of stl obj dae gltf ply off 3ds urdf srdf scene yaml mesh. Damages the built-in samples and the files of DIR (those
//! of the parser's kind below 64 KiB), and counts panics, readings slower than 2 s, and results too large for the
//! input. Limit the memory from outside (`ulimit -v`). The exit status is 1 if anything was found; the input is kept in
//! the temporary directory.

#[path = "../tests/common/corpus.rs"]
mod corpus;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use corpus::{PARSERS, Xorshift, mutate, run, samples};

const LARGEST_SEED: u64 = 64 * 1024;
const SLOW: Duration = Duration::from_secs(2);

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let parser = arguments.first().filter(|p| PARSERS.contains(&p.as_str()));
    let (Some(parser), Some(seconds)) = (parser, arguments.get(1).and_then(|s| s.parse().ok())) else {
        eprintln!("usage: fuzz PARSER SECONDS [DIR [SEED]], PARSER one of {}", PARSERS.join(" "));
        return ExitCode::from(2);
    };
    let mut corpus = samples(parser);
    if let Some(directory) = arguments.get(2) {
        collect(Path::new(directory), parser, &mut corpus);
    }
    let seed = arguments.get(3).and_then(|s| s.parse().ok()).unwrap_or(0x9e37_79b9_7f4a_7c15);
    std::panic::set_hook(Box::new(|_| {}));
    let report = fuzz(parser, Duration::from_secs(seconds), &corpus, Xorshift(seed));
    eprintln!("{parser}: {} files, {report}", corpus.len());
    ExitCode::from(u8::from(report.findings > 0))
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
        let outcome = catch_unwind(AssertUnwindSafe(|| run(parser, &bytes)));
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
