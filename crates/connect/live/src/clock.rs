//! The monotonic clock of a process.

use std::time::{Instant, SystemTime, UNIX_EPOCH};

use elbowroom_interlock::Micros;

/// The time since this clock was made. Never goes back, whatever happens to the time of day.
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    start: Instant,
}

impl Clock {
    /// A clock that shows 0 now.
    pub fn start() -> Self {
        Self { start: Instant::now() }
    }

    /// Microseconds since the start.
    pub fn micros(&self) -> Micros {
        Micros(self.start.elapsed().as_micros() as u64)
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}

/// A number for the start of a process that is higher for later ones, as long as the time of day is not set back: nanoseconds
/// since 1970.
pub fn boot_number() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |t| t.as_nanos() as u64)
}
