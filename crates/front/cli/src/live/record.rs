//! `elbowroom run --mcap`.

use std::path::Path;

use elbowroom::cell::Cell;
use elbowroom::rosbag::{BagError, CellWriter, RunRecorder};
use elbowroom::sim::{RunOptions, RunOutcome};

use crate::output::Failure;
use crate::simulation::with_observer;

/// Runs a cell and records it.
pub(crate) fn run_recorded(cell: &Cell, options: &RunOptions, file: &Path) -> Result<RunOutcome, Failure> {
    let failed = |e: BagError| Failure::Wrong(format!("{}: {e}", file.display()));
    // Simulated time begins at 0.
    let writer = CellWriter::create(file, cell, 0).map_err(failed)?;
    let mut recorder = RunRecorder::new(writer, cell);
    let outcome = with_observer(cell, options, Some(&mut recorder))?;
    recorder.finish().map_err(failed)?;
    Ok(outcome)
}
