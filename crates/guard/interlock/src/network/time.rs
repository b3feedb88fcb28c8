//! Times of one process.

use std::ops::{Add, Sub};

/// A time on the [`Clock`](crate::Clock) of one process, or a duration, in microseconds. Times of different
/// processes are never compared.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Micros(pub u64);

impl Micros {
    /// Converts a duration in seconds to whole microseconds, rounded up; 0 if `seconds` is not a valid duration.
    pub fn from_seconds(seconds: f64) -> Self {
        Self((seconds * 1e6).ceil().max(0.0) as u64)
    }

    /// An upper bound of this duration on the clock of another process. The rates of clocks may differ by one percent;
    /// the bound allows for twice that.
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

/// Saturates at 0.
impl Sub for Micros {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}
