//! A simulated run with a progress bar.

use elbowroom::cell::Cell;
use elbowroom::sim::run::{RunObserver, RunProgress, simulate_observed};
use elbowroom::sim::{RunOptions, RunOutcome};

use crate::output::Failure;
use crate::progress::Progress;

/// Runs the cell with a progress bar that appears after 0.7 s.
pub(crate) fn with_progress(cell: &Cell, options: &RunOptions) -> Result<RunOutcome, Failure> {
    with_observer(cell, options, None)
}

/// [`with_progress`] with an observer of the monitors.
pub(crate) fn with_observer(
    cell: &Cell,
    options: &RunOptions,
    observer: Option<&mut dyn RunObserver>,
) -> Result<RunOutcome, Failure> {
    let progress = Progress::unknown();
    let mut show = |p: RunProgress| {
        progress.go_on(format!("{:.1} s simulated, {} of {} programs finished", p.t_s, p.finished, p.robots));
    };
    let outcome = simulate_observed(cell, options, &mut show, observer);
    progress.end();
    Ok(outcome?)
}
