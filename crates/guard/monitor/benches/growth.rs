//! Growth of a tick with the number of regions: `cargo bench -p elbowroom-monitor --bench growth`.
//!
//! Two tables. In a larger and larger hall, the density of regions stays the same (a hundred in a ball of 1.8 m). In a
//! crowded cell, all are within 1.8 m of the arm's base; they shrink so that their volume together stays the same.

mod workload;

use elbowroom_monitor::Laws;
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};
use elbowroom_testkit::bench::{GrowthTable, Stopwatch, quantile};
use workload::{SLOW_S, monitor, regions, tick_times};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

const TICKS: u32 = 20_000;
/// Number of equal runs, of which each tick counts with its shortest time: other programs interrupt some ticks.
const RUNS: usize = 3;
/// Radius of the shell of regions around the arm, m.
const NEAREST_M: f64 = 0.3;
const FARTHEST_M: f64 = 1.8;

fn main() {
    let hall = |count: usize| ((FARTHEST_M * (count as f64 / 100.0).cbrt()).max(2.0 * NEAREST_M), 1.0);
    growth("regions of a larger hall", hall);
    growth("regions of a crowded cell", |count| (FARTHEST_M, (100.0 / count as f64).cbrt().min(1.0)));
}

/// Prints a table; `shell` returns the radius (m) of the farthest region and the scale of all.
fn growth(title: &str, shell: impl Fn(usize) -> (f64, f64)) {
    let columns =
        ["regions", "set-up ms", "median µs", "p99.9 µs", "pairs of a tick", "B/region", "allocations of all ticks"];
    let table = GrowthTable::start(title, &columns);
    for count in [1, 10, 100, 1_000, 10_000, 100_000] {
        let (farthest_m, scale) = shell(count);
        // As many in each part of the volume.
        let given = regions(count, |r| r.between(NEAREST_M.powi(3), farthest_m.powi(3)).cbrt(), scale);
        let counter = AllocationCounter::start();
        let watch = Stopwatch::start();
        let mut m = monitor(given.clone(), Laws::default());
        let (set_up_ms, bytes) = (watch.seconds() * 1e3, counter.held_bytes() as f64);
        let counter = AllocationCounter::start();
        let (mut times, pairs) = tick_times(&mut m, TICKS, SLOW_S, false);
        // The list of times is one.
        let allocations = counter.allocations() - 1;
        for _ in 1..RUNS {
            let (again, _) = tick_times(&mut monitor(given.clone(), Laws::default()), TICKS, SLOW_S, false);
            times.iter_mut().zip(again).for_each(|(time, again)| *time = time.min(again));
        }
        let (median, late) = (quantile(&mut times, 0.5), quantile(&mut times, 0.999));
        table.row(&[count as f64, set_up_ms, median, late, pairs, bytes / count as f64, allocations as f64]);
    }
}
