//! The table of inverse kinematics over every robot of the data:
//! `cargo run --release -p elbowroom-kinematics --example ik_table [TARGETS]` (data as in the tests, `ELBOWROOM_DATA`).
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use common::measure::{Line, measure};

fn main() {
    let targets = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(10_000).max(1);
    println!("{}", Line::HEAD);
    for (name, path) in common::robots() {
        println!("{}", measure(&common::load(&path), targets).text(&name));
    }
}
