//! Histogram of times in whole microseconds.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Count of each measured time. Exact, and small if many times are equal.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Latencies {
    counts_us: BTreeMap<u64, u64>,
}

impl Latencies {
    pub fn add_us(&mut self, time_us: u64) {
        *self.counts_us.entry(time_us).or_default() += 1;
    }

    pub fn merge(&mut self, other: &Self) {
        for (time_us, count) in &other.counts_us {
            *self.counts_us.entry(*time_us).or_default() += count;
        }
    }

    pub fn count(&self) -> u64 {
        self.counts_us.values().sum()
    }

    /// Returns the quantile of the times for this fraction, µs; 0 without any: the least time that at least this
    /// fraction of all times does not exceed.
    pub fn quantile_us(&self, share: f64) -> u64 {
        let rank = (share * self.count() as f64).ceil().max(1.0) as u64;
        let mut below = 0;
        for (time_us, count) in &self.counts_us {
            below += count;
            if below >= rank {
                return *time_us;
            }
        }
        0
    }
}
