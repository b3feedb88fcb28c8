//! Times: five rounds, each entry once per round, on the same records.

use super::groups::Group;
use super::runner::Runner;

const ROUNDS: usize = 5;
/// Time per record, ns, above which an entry gets fewer records and rounds, so that the rest need not wait.
const SLOW_NS: f64 = 3e6;
/// Least duration of a round, ns, so that the resolution of the clock and cold caches do not matter.
const SHORTEST_NS: f64 = 2e7;

/// Measured time of one entry.
#[derive(Debug, Clone, Copy)]
pub struct Time {
    /// Median of the rounds, nanoseconds per record.
    pub mean_ns: f64,
    pub records: usize,
}

/// Duration of a round, ns: `BUDGET`, in seconds.
pub fn budget_ns() -> f64 {
    let seconds = std::env::var("BUDGET").ok().and_then(|text| text.parse::<f64>().ok());
    seconds.filter(|s| *s > 0.0).unwrap_or(0.5) * 1e9
}

/// Measures the entries in their order; `None` if not wanted, or if the runner has failed.
pub fn group(group: &Group, runners: &mut [Runner]) -> Vec<Option<Time>> {
    let budget = budget_ns();
    let costs: Vec<Option<f64>> = group
        .entries
        .iter()
        .map(|e| if e.timed { rough(&mut runners[e.runner], e.number, e.cell.records) } else { None })
        .collect();
    let within = |cost: f64, least: usize, all: usize| ((budget / cost) as usize).clamp(least.min(all), all);
    // All entries except slow ones are timed on the same records.
    let shared = group.entries.iter().zip(&costs).filter_map(|(e, cost)| {
        let cost = cost.filter(|c| *c < SLOW_NS)?;
        Some(within(cost, 20, e.cell.records))
    });
    let shared = shared.min().unwrap_or(usize::MAX);
    let mut rounds: Vec<Vec<f64>> = vec![Vec::new(); costs.len()];
    let records_of = |k: usize, cost: f64| {
        let all = group.entries[k].cell.records;
        if cost < SLOW_NS { shared.min(all) } else { within(cost, 6, all) }
    };
    for round in 0..ROUNDS {
        for turn in 0..costs.len() {
            // Each round begins with another entry, so that no entry always follows the same one.
            let k = (turn + round) % costs.len();
            let Some(cost) = costs[k].filter(|c| *c < SLOW_NS || round < 3) else { continue };
            let records = records_of(k, cost);
            let passes = (SHORTEST_NS.min(budget) / (cost * records as f64)).ceil().clamp(1.0, 1e6) as usize;
            let entry = &group.entries[k];
            rounds[k].extend(runners[entry.runner].time(entry.number, records, passes));
        }
    }
    let time = |(k, mut times): (usize, Vec<f64>)| {
        let records = records_of(k, costs[k]?);
        times.sort_by(f64::total_cmp);
        Some(Time { mean_ns: *times.get(times.len() / 2)?, records })
    };
    rounds.into_iter().enumerate().map(time).collect()
}

/// Estimates the time per record from a few records.
fn rough(runner: &mut Runner, number: usize, records: usize) -> Option<f64> {
    let first = runner.time(number, 1, 1)?;
    if first > 1e7 {
        return Some(first);
    }
    let more = runner.time(number, records.min(10), 1)?;
    if more > 1e6 {
        return Some(more);
    }
    Some(runner.time(number, records.min(200), 1)?.max(1.0))
}
