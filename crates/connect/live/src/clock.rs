//! Clock of a process, and the number of its start.

use std::time::{Duration, SystemTime, UNIX_EPOCH};

use elbowroom_interlock::Micros;

/// A clock that shows the time since it was made, and never goes back ([`elbowroom_interlock::Clock`]).
///
/// ```
/// use elbowroom_live::Clock;
/// let clock = Clock::start();
/// let first = clock.micros();
/// assert!(clock.micros() >= first && clock.seconds() < 60.0);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Clock(Time);

/// Where the time comes from.
#[derive(Debug, Clone, Copy)]
enum Time {
    System(elbowroom_interlock::Clock),
    #[cfg(test)]
    Simulated(crate::simulated_service::ProcessClock),
}

impl Clock {
    /// Makes a clock that shows 0 now.
    pub fn start() -> Self {
        Self(Time::System(elbowroom_interlock::Clock::start()))
    }

    /// Makes the clock of a simulated process.
    #[cfg(test)]
    pub(crate) fn simulated(clock: crate::simulated_service::ProcessClock) -> Self {
        Self(Time::Simulated(clock))
    }

    #[cfg(test)]
    pub(crate) fn is_simulated(&self) -> bool {
        matches!(self.0, Time::Simulated(_))
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
        match &self.0 {
            Time::System(clock) => clock.elapsed(),
            #[cfg(test)]
            Time::Simulated(clock) => Duration::from_micros(clock.micros().0),
        }
    }

    /// Lets the calling thread rest for this time.
    pub(crate) fn sleep(&self, time: Duration) {
        match &self.0 {
            Time::System(_) => std::thread::sleep(time),
            #[cfg(test)]
            Time::Simulated(clock) => clock.sleep(time),
        }
    }
}

/// Number of a process start, in nanoseconds since 1970: higher for later starts, provided that the time of day is not set
/// back.
pub fn boot_number() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |t| t.as_nanos() as u64)
}
