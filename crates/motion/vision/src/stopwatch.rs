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
    /// Begins the first interval.
    pub fn start() -> Self {
        Self(Instant::now())
    }

    /// The time since the start or the last lap; the next interval begins.
    pub fn lap(&mut self) -> Duration {
        let now = Instant::now();
        now - std::mem::replace(&mut self.0, now)
    }
}
