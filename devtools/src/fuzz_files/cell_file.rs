//! Mutation fuzzing of the cell file: `cargo xtask fuzz cell-file FILE SECONDS [SEED]`.
//!
//! Mutates bytes, lines and numbers of FILE, resolves the result and runs it for a few ticks. Counts panics and
//! readings slower than 5 s; an error if there were any. Such inputs are kept in the temporary directory.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use elbowroom_cell::Cell;
use elbowroom_sim::{RunOptions, simulate};
use elbowroom_testkit::random::Random;
use xtask::Failure;

use super::words::{SEED, number};

const NUMBERS: &[&str] =
    &["0", "-1", "1e308", "-1e308", "1e-320", "nan", "inf", "9223372036854775807", "\"x\"", "[]", "{}"];

fn mutate(text: &str, random: &mut Random) -> String {
    let mut text = text.to_owned();
    for _ in 0..=random.below(4) {
        match random.below(3) {
            0 => {
                let mut bytes = text.into_bytes();
                let i = random.below(bytes.len());
                if let Some(b) = bytes.get_mut(i) {
                    *b = random.below(256) as u8;
                }
                text = String::from_utf8_lossy(&bytes).into_owned();
            }
            1 => {
                let mut lines: Vec<&str> = text.lines().collect();
                let line = lines.get(random.below(lines.len())).copied().unwrap_or("");
                if random.below(2) == 0 && lines.len() > 1 {
                    lines.remove(random.below(lines.len()));
                }
                lines.insert(random.below(lines.len()), line);
                text = lines.join("\n");
            }
            _ => {
                let digits: Vec<usize> = text.match_indices(|c: char| c.is_ascii_digit()).map(|m| m.0).collect();
                if let Some(&at) = digits.get(random.below(digits.len())) {
                    text.replace_range(at..=at, NUMBERS[random.below(NUMBERS.len())]);
                }
            }
        }
    }
    text
}

/// Options of `fuzz cell-file`.
pub struct Options {
    file: PathBuf,
    seconds: u64,
    seed: u64,
}

impl Options {
    /// Reads `FILE SECONDS [SEED]`.
    pub fn parse(words: &[&str]) -> Result<Self, String> {
        let file = words.first().ok_or("FILE is missing")?.into();
        Ok(Self {
            file,
            seconds: number("SECONDS", words.get(1), None)?,
            seed: number("SEED", words.get(2), Some(SEED))?,
        })
    }
}

/// Mutates and runs the file until the time is over.
pub fn run(options: &Options) -> Result<(), Failure> {
    let file: &Path = &options.file;
    let text = std::fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
    let mut random = Random(options.seed);
    std::panic::set_hook(Box::new(|_| {}));
    let (begin, mut tried, mut sound, mut found) = (Instant::now(), 0_u64, 0_u64, 0_u64);
    while begin.elapsed() < Duration::from_secs(options.seconds) {
        let spoiled = mutate(&text, &mut random);
        let started = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            Cell::parse(file, &spoiled).is_ok_and(|mut cell| {
                cell.timing.max_s = cell.timing.tick_s * 5.0;
                let _ = simulate(&cell, &RunOptions::default());
                true
            })
        }));
        tried += 1;
        sound += u64::from(matches!(outcome, Ok(true)));
        if outcome.is_err() || started.elapsed() > Duration::from_secs(5) {
            found += 1;
            let kept = std::env::temp_dir().join(format!("fuzz_cell_{found}.toml"));
            let _ = std::fs::write(&kept, &spoiled);
            eprintln!(
                "{} after {:?}: {}",
                if outcome.is_err() { "panic" } else { "slow" },
                started.elapsed(),
                kept.display()
            );
        }
    }
    eprintln!("{}: {tried} files, {sound} valid", file.display());
    if found == 0 { Ok(()) } else { Err(Failure::Check(format!("{found} panics or slow readings"))) }
}
