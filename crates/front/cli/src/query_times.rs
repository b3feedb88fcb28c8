//! `query --times`: the time per state, and which resolution levels answered.

use std::collections::BTreeMap;
use std::fmt;

use elbowroom::query::{Level, QueryEffort};
use serde::Serialize;

/// Times of the states of a query, and counts of its answers.
#[derive(Debug, Serialize)]
pub(crate) struct QueryTimes {
    states: usize,
    mean_us: f64,
    p50_us: f64,
    p99_us: f64,
    /// Queries by the finest level that each needed.
    answered: BTreeMap<String, u64>,
    /// Pairs that the allowed collision matrix left out.
    pairs_skipped: u64,
}

impl QueryTimes {
    /// Sorts and counts.
    pub(crate) fn of(effort: QueryEffort) -> Self {
        let mut times = effort.times_s;
        times.sort_by(f64::total_cmp);
        let at = |share: f64| times.get((times.len() as f64 * share) as usize).map_or(0.0, |t| 1e6 * t);
        let answered = Level::ANSWERING.map(|level| (level.to_string(), effort.stats.answered.get(level)));
        Self {
            states: times.len(),
            mean_us: 1e6 * times.iter().sum::<f64>() / times.len().max(1) as f64,
            p50_us: at(0.5),
            p99_us: at(0.99),
            answered: answered.into_iter().filter(|(_, n)| *n > 0).collect(),
            pairs_skipped: effort.stats.pairs_skipped,
        }
    }
}

impl fmt::Display for QueryTimes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { states, mean_us, p50_us, p99_us, .. } = self;
        let plural = if *states == 1 { "" } else { "s" };
        write!(f, "{states} state{plural}: {mean_us:.2} µs mean, {p50_us:.2} median, {p99_us:.2} p99; answered by")?;
        self.answered.iter().try_for_each(|(level, n)| write!(f, " {level} {n}"))?;
        write!(f, "; pairs left out by the matrix {}", self.pairs_skipped)
    }
}
