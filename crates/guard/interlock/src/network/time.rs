//! Times of one process.

use std::ops::{Add, Sub};

/// A time on the [`Clock`](crate::Clock) of one process, or a length of time, in microseconds. Times of different processes are never
/// compared.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Micros(pub u64);

impl Micros {
    /// Whole microseconds of a length of time in seconds, rounded up; 0 for what is not a length of time.
    pub fn from_seconds(seconds: f64) -> Self {
        Self((seconds * 1e6).ceil().max(0.0) as u64)
    }

    /// This length of time on the clock of another process. Clocks may differ by one percent in rate; twice that is waited.
    pub(crate) fn with_drift(self) -> Self {
        self + Self(self.0 / 50 + 1)
    }
}

impl Add for Micros {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

/// 0 if the difference would be negative.
impl Sub for Micros {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}
