//! `elbowroom run --mcap`.

use std::path::Path;

use elbowroom::recording::{BagError, CellWriter, RunRecorder};
use elbowroom::sim::{RunOptions, RunOutcome};

use crate::output::Failure;
use crate::simulation::Simulation;

/// Runs a cell and records it.
pub(crate) fn run_recorded(
    simulation: &Simulation<'_>,
    options: &RunOptions,
    file: &Path,
) -> Result<RunOutcome, Failure> {
    let failed = |e: BagError| Failure::Wrong(format!("{}: {e}", file.display()));
    // Simulated time begins at 0.
    let writer = CellWriter::create(file, simulation.paths.cell(), 0).map_err(failed)?;
    let mut recorder = RunRecorder::new(writer, simulation.paths.cell());
    let outcome = simulation.observed(options, Some(&mut recorder))?;
    recorder.finish().map_err(failed)?;
    Ok(outcome)
}
