//! Time per state of queries, by the library: what `elbowroom.Checker` of Python is compared with.
//!
//! `cargo bench -p elbowroom-query --bench row_times -- ROBOT.urdf ROBOT.srdf STATES` reads states as little-endian float64, a row
//! after another, and prints the microseconds per state of collisions and of distances, on one thread.

#![allow(clippy::print_stdout, reason = "a bench prints what it measures")]

use std::num::NonZeroUsize;
use std::path::Path;
use std::time::Instant;

use elbowroom_cell::{OutOfReachProofs, QueryModel};
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_query::{Query, QueryKind, QueryPairs, QueryStates, evaluate_query};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let [robot, srdf, states] = &words[..] else {
        return Err("usage: row_times ROBOT.urdf ROBOT.srdf STATES".into());
    };
    let options = LoadOptions { srdf: Some(srdf.into()), ..LoadOptions::default() };
    let model = QueryModel::of_robot(Path::new(robot), load(Path::new(robot), &options)?.robot);
    let scene = model.scene(OutOfReachProofs::Compute)?;
    let start = model.start_state(&scene)?;
    let bytes = std::fs::read(states)?;
    let values = bytes.as_chunks().0.iter().map(|value| f64::from_le_bytes(*value)).collect();
    let (states, pairs) = (QueryStates::of_rows(&model, values), QueryPairs::all());
    for (name, kind) in [("collision", QueryKind::Collision), ("distance", QueryKind::Distance)] {
        let query = Query { threads: NonZeroUsize::new(1), ..Query::new(kind, &pairs, &start) };
        let (begin, mut rows) = (Instant::now(), 0);
        evaluate_query(&scene, &states, &query, &mut |block| {
            rows += block.len();
            true
        })?;
        println!("{name} {:.3}", 1e6 * begin.elapsed().as_secs_f64() / rows as f64);
    }
    Ok(())
}
