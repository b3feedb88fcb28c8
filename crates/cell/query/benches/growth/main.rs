//! Growth of a row of a query: with obstacles, with robots; memory with the number of rows.
//!
//! `cargo bench -p elbowroom-query --bench growth -- [PART]` prints a table each, on one thread; with PART, only the tables with
//! PART in their names. Times are for free states of RX60B arms (23,012 triangles each): these need the whole proof.

mod surroundings;
mod workload;

use std::error::Error;
use std::io::Write as _;

use elbowroom_query::{QueryKind, QueryStates};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};
use elbowroom_testkit::bench::{GrowthTable, arguments};
use surroundings::{Surroundings, cell_in_parts, hall, line_of_robots};
use workload::Workload;

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

const OBSTACLES: [usize; 9] = [10, 30, 100, 300, 1_000, 3_000, 10_000, 30_000, 100_000];
const ROBOTS: [usize; 5] = [1, 2, 4, 8, 16];
const ROWS: [usize; 3] = [10_000, 100_000, 1_000_000];
/// Columns of the tables of times.
const TIMES: [&str; 9] = [
    "scene ms",
    "scene with proofs ms",
    "collision µs",
    "tolerance µs",
    "distance µs",
    "copied checker µs",
    "scene B/each",
    "checker B/each",
    "allocations of a row",
];

fn main() -> Result<()> {
    let part = arguments().next().unwrap_or_default();
    times("obstacles of a larger hall", &part, &OBSTACLES, hall)?;
    times("obstacles that are parts of one cell", &part, &OBSTACLES, cell_in_parts)?;
    times("robots", &part, &ROBOTS, line_of_robots)?;
    if "rows".contains(&part) {
        rows()?;
    }
    Ok(())
}

fn times(title: &str, part: &str, sizes: &[usize], surroundings: fn(usize) -> Surroundings) -> Result<()> {
    if !title.contains(part) {
        return Ok(());
    }
    let table = GrowthTable::start(title, &[&[title.split(' ').next().unwrap_or_default()], &TIMES[..]].concat());
    for &size in sizes {
        let given = surroundings(size);
        let size = given.size as f64;
        let counter = AllocationCounter::start();
        let workload = Workload::new(&given)?;
        let scene_bytes = counter.held_bytes() as f64 / size;
        let times = workload.times()?;
        let [checker_bytes, allocations] = workload.memory()?;
        table.row(&[&[size][..], &times, &[scene_bytes, checker_bytes / size, allocations]].concat());
    }
    Ok(())
}

/// Memory of the states of a query, and of its evaluation beside them.
fn rows() -> Result<()> {
    let columns = ["rows", "collision µs", "states B/row", "evaluation kB", "allocations of a row"];
    let table = GrowthTable::start("rows", &columns);
    let workload = Workload::new(&hall(10))?;
    for count in ROWS {
        let counter = AllocationCounter::start();
        let states = QueryStates::of_rows(&workload.model, workload.values(count));
        let states_bytes = counter.held_bytes() as f64;
        let counter = AllocationCounter::start();
        let mut most = 0;
        let seconds =
            workload.evaluate(&states, QueryKind::Collision, &mut || most = most.max(counter.held_bytes()))?;
        let n = count as f64;
        let allocations = counter.allocations() as f64 / n;
        table.row(&[n, seconds / n * 1e6, states_bytes / n, (most as f64 / 1e3).round(), allocations]);
    }
    Ok(std::io::stdout().flush()?)
}
