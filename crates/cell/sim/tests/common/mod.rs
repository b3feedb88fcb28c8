//! The cells of `elbowroom-cell`'s tests, and running them.
#![allow(dead_code)]

pub mod crossing;

use elbowroom_sim::{RunOptions, RunOutcome, simulate};

#[path = "../../../cell/tests/common/mod.rs"]
mod cells;

pub use cells::*;

pub fn run(text: &str) -> RunOutcome {
    simulate(&parse(text), &RunOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

pub fn run_free(text: &str) -> RunOutcome {
    let options = RunOptions { apply_override: false, ..RunOptions::default() };
    simulate(&parse(text), &options).unwrap_or_else(|e| panic!("{e}"))
}
