//! Clock of a process, and the number of its start.

use std::time::{SystemTime, UNIX_EPOCH};

pub use elbowroom_interlock::Clock;

/// Number of a process start, in nanoseconds since 1970: higher for later starts, provided that the time of day is not set
/// back.
pub fn boot_number() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |t| t.as_nanos() as u64)
}
