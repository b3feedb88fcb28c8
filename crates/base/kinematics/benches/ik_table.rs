//! The table of inverse kinematics over every robot of the data.
//!
//! `cargo bench -p elbowroom-kinematics --bench ik_table -- [TARGETS]` (data as in the tests, `ELBOWROOM_DATA`)
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::measure::{Line, measure};

fn main() {
    let targets = elbowroom_testkit::bench::arguments().next().and_then(|n| n.parse().ok()).unwrap_or(10_000).max(1);
    println!("{}", Line::HEAD);
    for (name, path) in common::robots() {
        println!("{}", measure(&common::load(&path), targets).text(&name));
    }
}
