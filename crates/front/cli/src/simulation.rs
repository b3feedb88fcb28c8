//! Checks and runs of a cell, with progress.

use std::cell::RefCell;
use std::rc::Rc;

use elbowroom::cell::Cell;
use elbowroom::sim::check::{EntryCheck, check_planned, overruns};
use elbowroom::sim::run::{RunObserver, RunProgress, simulate_observed};
use elbowroom::sim::{PathSearch, PlannedPaths, RunOptions, RunOutcome};

use crate::output::{Failure, note};
use crate::progress::Progress;

/// A cell for checks and runs, also repeated ones: the paths of its planned moves are searched only once.
pub(crate) struct Simulation<'a> {
    pub(crate) paths: PlannedPaths<'a>,
    /// Progress of the present computation.
    progress: Rc<RefCell<Option<Progress>>>,
}

impl<'a> Simulation<'a> {
    pub(crate) fn of(cell: &'a Cell) -> Self {
        let progress = Rc::<RefCell<Option<Progress>>>::default();
        let shown = progress.clone();
        let paths = PlannedPaths::new(cell).with_progress(move |PathSearch { number, of }| {
            shown.borrow().iter().for_each(|progress| progress.go_on(format!("planning move {number} of {of}")));
        });
        Self { paths, progress }
    }

    /// Checks which entries the laws exclude.
    pub(crate) fn check(&self) -> Result<Vec<EntryCheck>, Failure> {
        Ok(self.with_progress(|| check_planned(&self.paths))?)
    }

    /// Warns of borders that a robot can reach faster than it can stop.
    pub(crate) fn warn_of_overruns(&self) -> Result<(), Failure> {
        let overruns = self.with_progress(|| overruns(&self.paths))?;
        for w in overruns {
            note(format_args!("warning: {w}"));
        }
        Ok(())
    }

    pub(crate) fn run(&self, options: &RunOptions) -> Result<RunOutcome, Failure> {
        self.observed(options, None)
    }

    /// Runs with an observer of the monitors.
    pub(crate) fn observed(
        &self,
        options: &RunOptions,
        observer: Option<&mut dyn RunObserver>,
    ) -> Result<RunOutcome, Failure> {
        let mut show = |p: RunProgress| {
            let RunProgress { t_s, finished, robots } = p;
            let done = format!("{t_s:.1} s simulated, {finished} of {robots} programs finished");
            self.progress.borrow().iter().for_each(|progress| progress.go_on(done.clone()));
        };
        Ok(self.with_progress(|| simulate_observed(&self.paths, options, &mut show, observer))?)
    }

    fn with_progress<T>(&self, compute: impl FnOnce() -> T) -> T {
        self.progress.replace(Some(Progress::unknown()));
        let result = compute();
        self.progress.take().iter().for_each(Progress::end);
        result
    }
}
