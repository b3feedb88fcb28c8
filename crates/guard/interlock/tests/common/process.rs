//! Processes that pause, crash and restart, each with its own clock.

use elbowroom_interlock::{Arbiter, Micros};
use elbowroom_testkit::random::{split_mix, unit};

#[derive(Debug)]
pub struct Process {
    pub down_until_ms: u64,
    pub paused_until_ms: u64,
    offset: u64,
    /// Rate of the clock, 1 ± 0.5 %.
    rate: f64,
}

impl Process {
    pub fn new(rng: &mut u64) -> Self {
        let rate = 0.995 + 0.01 * unit(split_mix(rng));
        Self { down_until_ms: 0, paused_until_ms: 0, offset: split_mix(rng) % 1_000_000_000, rate }
    }

    pub fn runs(&self, ms: u64) -> bool {
        ms >= self.down_until_ms && ms >= self.paused_until_ms
    }

    pub fn clock(&self, ms: u64) -> Micros {
        Micros(self.offset + (ms as f64 * 1e3 * self.rate) as u64)
    }
}

/// An arbiter and its process. While it pauses, another one may be started; then both run for a moment.
pub struct ArbiterProcess {
    pub id: u64,
    pub arbiter: Arbiter,
    pub process: Process,
    /// Time at which somebody stops it, because another one runs.
    pub ends_ms: u64,
}
