//! Pseudo-random numbers, the same on every machine.
#![allow(dead_code)]

use elbowroom_testkit::random::{linear_congruential, unit};

/// A linear congruential generator of 64 bits.
pub struct Random(pub u64);

impl Random {
    /// A number of `[low, high)`.
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * unit(linear_congruential(&mut self.0))
    }

    /// A whole number below `count`; 0 for a count of 0.
    pub fn below(&mut self, count: usize) -> usize {
        // The low bits have short periods.
        ((linear_congruential(&mut self.0) >> 11) % count.max(1) as u64) as usize
    }
}
