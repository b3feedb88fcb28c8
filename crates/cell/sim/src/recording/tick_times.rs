//! Times of ticks.

/// Statistics of wall-clock times, nanoseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TickTimes {
    /// Median.
    pub p50: u64,
    /// 99th percentile.
    pub p99: u64,
    /// Largest.
    pub max: u64,
    /// Number of samples.
    pub count: usize,
}

impl TickTimes {
    /// Computes the statistics of the times of all ticks, ns.
    pub fn of(mut ns: Vec<u64>) -> Self {
        ns.sort_unstable();
        let at = |share: f64| {
            ns.get(((ns.len() as f64 * share) as usize).min(ns.len().saturating_sub(1))).copied().unwrap_or(0)
        };
        Self { p50: at(0.5), p99: at(0.99), max: ns.last().copied().unwrap_or(0), count: ns.len() }
    }
}
