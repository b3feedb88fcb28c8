//! Times of consecutive stages.

use std::time::{Duration, Instant};

/// Measures consecutive intervals of wall-clock time.
///
/// ```
/// let mut stopwatch = elbowroom_vision::Stopwatch::start();
/// let (first, second) = (stopwatch.lap(), stopwatch.lap());
/// assert!((first + second).as_secs() < 60);
/// ```
#[derive(Debug, Clone)]
pub struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts the first interval.
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// Returns the time since the start or the last lap, and starts the next interval.
    pub fn lap(&mut self) -> Duration {
        let now = Instant::now();
        now - std::mem::replace(&mut self.0, now)
    }
}
