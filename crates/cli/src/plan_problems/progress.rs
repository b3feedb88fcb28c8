//! Progress on standard error, where that is a terminal.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use elbowroom::analysis::problems::ProblemResult;
use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A bar that appears after 2 s.
pub(super) struct Progress {
    total: usize,
    done: usize,
    unsolved: usize,
    begin: Instant,
    bar: ProgressBar,
}

impl Progress {
    pub(super) fn new(total: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(total as u64), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos} of {len} problems, {msg}") {
            bar.set_style(style);
        }
        Self { total, done: 0, unsolved: 0, begin: Instant::now(), bar }
    }

    /// After each problem.
    pub(super) fn next(&mut self, result: &ProblemResult) {
        self.done += 1;
        self.unsolved += usize::from(result.valid && !result.found);
        let elapsed = self.begin.elapsed();
        if elapsed < Duration::from_secs(2) || !std::io::stderr().is_terminal() {
            return;
        }
        if self.bar.is_hidden() {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        let left = elapsed.mul_f64(self.total.saturating_sub(self.done) as f64 / self.done as f64);
        self.bar.set_message(format!("{} not solved, {} left", self.unsolved, HumanDuration(left)));
        self.bar.set_position(self.done as u64);
    }

    pub(super) fn end(&self) {
        self.bar.finish_and_clear();
    }
}
