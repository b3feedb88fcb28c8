//! The clock of a process, and the numbers of its starts.

use std::time::{SystemTime, UNIX_EPOCH};

pub use elbowroom_interlock::Clock;

/// A number for the start of a process that is higher for later ones, as long as the time of day is not set back: nanoseconds
/// since 1970.
pub fn boot_number() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |t| t.as_nanos() as u64)
}
