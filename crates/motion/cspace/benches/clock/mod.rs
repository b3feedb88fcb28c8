//! Processor time of this thread.

use std::time::Duration;

/// Returns the shortest time of several rounds.
pub fn best(rounds: usize, mut run: impl FnMut()) -> Duration {
    let once = |_| {
        let start = processor_time();
        run();
        processor_time().saturating_sub(start)
    };
    (0..rounds).map(once).min().unwrap_or_default()
}

#[cfg(unix)]
fn processor_time() -> Duration {
    use rustix::time::{ClockId, clock_gettime};
    Duration::try_from(clock_gettime(ClockId::ThreadCPUTime)).unwrap_or_default()
}

/// Returns wall-clock time if the system does not measure processor time.
#[cfg(not(unix))]
fn processor_time() -> Duration {
    static START: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    START.get_or_init(std::time::Instant::now).elapsed()
}
