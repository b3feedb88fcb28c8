//! One cell, run and checked.

use elbowroom_cell::Cell;
use elbowroom_sim::{InputFault, Recording, RunOptions, simulate};

use super::generate::Places;
use super::oracle::{self, Findings, Promises};
use super::pictures::PictureFolders;
use super::spec::CellSpec;

/// A run and the findings of the oracle.
pub struct CheckedRun {
    pub findings: Findings,
    pub finished: usize,
    pub slowed: usize,
    pub stopped: usize,
    pub robots: usize,
    pub simulated_s: f64,
}

/// Runs a cell of this text with these faults of its input; `repeat` is the number of passes, as in `run --repeat`.
pub fn run(cell: &Cell, text: &str, faults: &[InputFault], repeat: u32) -> Result<CheckedRun, String> {
    run_and_judge(cell, faults, repeat, |recording, findings| {
        oracle::as_written::check(text, cell, recording, findings);
    })
}

/// Like [`run`], for a cell that is not written to a file yet: whether its recordings are played as written, and its scenes
/// are where they were written, is judged too.
pub fn run_spec(spec: &CellSpec, places: &Places<'_>) -> Result<CheckedRun, String> {
    let cell = spec.parse(places.cells)?;
    let _pictures = PictureFolders::write(spec, places.cells)?;
    run_and_judge(&cell, &spec.faults, spec.repeat, |recording, findings| {
        oracle::as_written::check(&spec.to_toml(), &cell, recording, findings);
        oracle::as_written::check_scenes(spec, &cell, findings);
        oracle::recorded::check(spec, recording, findings);
        oracle::seen::check(spec, &cell, recording, findings);
    })
}

fn run_and_judge(
    cell: &Cell,
    faults: &[InputFault],
    repeat: u32,
    judge: impl Fn(&Recording, &mut Findings),
) -> Result<CheckedRun, String> {
    let options = RunOptions { faults: faults.to_vec(), repeat: repeat.max(1), ..RunOptions::default() };
    let outcome = simulate(cell, &options).map_err(|e| e.to_string())?;
    let robots = &outcome.recording.robots;
    let mut findings = oracle::check(cell, &outcome.recording, &Promises::new(cell), outcome.has_violation());
    oracle::readings::check(cell, &outcome.recording, faults, &mut findings);
    judge(&outcome.recording, &mut findings);
    Ok(CheckedRun {
        findings,
        finished: robots.iter().filter(|r| r.finished).count(),
        slowed: robots.iter().filter(|r| r.min_override < 0.2).count(),
        stopped: robots.iter().filter(|r| r.stopped_s > 0.0).count(),
        robots: robots.len(),
        simulated_s: outcome.recording.duration_s,
    })
}
