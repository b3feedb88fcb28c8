//! Progress on standard error.

use std::time::{Duration, Instant};

use super::part::Part;

/// Time between two lines.
const PERIOD: Duration = Duration::from_secs(10);

/// Progress of a part.
pub struct Progress {
    part: Part,
    all: usize,
    begin: Instant,
    printed: Instant,
}

impl Progress {
    /// Creates the progress of a part with this many steps.
    pub fn new(part: Part, all: usize) -> Self {
        let now = Instant::now();
        Self { part, all, begin: now, printed: now }
    }

    /// Prints a line if the last one is old enough.
    pub fn done(&mut self, steps: usize, step: &str) {
        if self.printed.elapsed() < PERIOD && steps < self.all {
            return;
        }
        self.printed = Instant::now();
        let seconds = self.begin.elapsed().as_secs();
        eprintln!("{}: {steps} of {}, {seconds} s ({step})", self.part.name(), self.all);
    }
}
