//! The clock for the ages of grants and messages.

use std::time::Duration;

use crate::Micros;

/// A clock that shows the time since it was made. It never goes back, whatever happens to the time of day. On Linux
/// it continues while the computer is suspended, so the time of the suspension counts towards the end of a grant.
///
/// ```
/// use elbowroom_interlock::Clock;
/// let clock = Clock::start();
/// let first = clock.micros();
/// assert!(clock.micros() >= first && clock.seconds() < 60.0);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Clock {
    start: Duration,
}

impl Clock {
    /// A clock that shows 0 now.
    pub fn start() -> Self {
        Self { start: now() }
    }

    /// Microseconds since the start.
    pub fn micros(&self) -> Micros {
        Micros(self.elapsed().as_micros() as u64)
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.elapsed().as_secs_f64()
    }

    /// The time since the start.
    pub fn elapsed(&self) -> Duration {
        now().saturating_sub(self.start)
    }
}

/// Time since the computer was started, including the time when it was suspended.
#[cfg(target_os = "linux")]
fn now() -> Duration {
    let since_boot = rustix::time::clock_gettime(rustix::time::ClockId::Boottime);
    Duration::new(since_boot.tv_sec.max(0) as u64, since_boot.tv_nsec.max(0) as u32)
}

/// Time since the first call.
#[cfg(not(target_os = "linux"))]
fn now() -> Duration {
    static FIRST: std::sync::OnceLock<std::time::Instant> = std::sync::OnceLock::new();
    FIRST.get_or_init(std::time::Instant::now).elapsed()
}
