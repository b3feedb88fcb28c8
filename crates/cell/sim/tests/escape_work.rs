//! The hardest runs of `cargo xtask evade`: without a contact, and without a step that exceeds a tick in counted work.
#![allow(clippy::print_stdout)]

use crate::common::crossing;
use std::path::Path;

use elbowroom_cell::{Cell, Drive};
use elbowroom_robot::ObjectId;
use elbowroom_sim::RunOptions;
use elbowroom_sim::run::simulate;

/// Runs that hit before escapes were kept known, or that need most of them, and the time at which the arm is back on
/// its path, s.
const HARD: [(usize, f64); 2] = [(135, 9.4), (160, 4.4)];

#[test]
fn hard_runs_do_not_hit() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/evade.toml");
    let cell = Cell::load(file).unwrap();
    let moves = |o: &ObjectId| cell.moving_objects.iter().any(|m| m.object == *o);
    let object = cell.robots[0].avoidance.as_ref().unwrap().objects.iter().copied().find(moves).unwrap();
    let seconds = crossing::without_obstacle(&cell).unwrap().duration_s;
    let only = std::env::var("ELBOWROOM_EVADE_RUNS").ok();
    let long = elbowroom_testkit::extent::is_long_run();
    let runs: Vec<usize> =
        only.map_or(HARD.map(|(n, _)| n).to_vec(), |o| o.split(',').map(|n| n.trim().parse().unwrap()).collect());
    let paths = crossing::paths(&cell, object, seconds, runs.iter().max().unwrap() + 1).unwrap();
    for n in runs {
        let mut cell = cell.clone();
        // After that time, the arm of these runs is on its path.
        if let Some((_, back_s)) = HARD.iter().find(|(hard, _)| *hard == n && !long) {
            cell.timing.max_s = back_s + 0.5;
        }
        cell.moving_objects.iter_mut().find(|m| m.object == object).unwrap().drive = Drive::Path(paths[n].clone());
        let recording = simulate(&cell, &RunOptions::default()).unwrap().recording;
        let robot = &recording.robots[0];
        let steps = robot.avoidance.as_ref().unwrap().step_ns;
        println!(
            "run {n}: {:.2} s, finished {}, hits {}, step p50 {} p99 {} max {} us",
            recording.duration_s,
            robot.finished,
            robot.collisions.len(),
            steps.p50 / 1000,
            steps.p99 / 1000,
            steps.max / 1000
        );
        assert!(
            robot.avoidance.as_ref().unwrap().samples.iter().any(|s| s.path_deviation_s > 0.0),
            "run {n}: no evasion"
        );
        assert!(robot.collisions.is_empty(), "run {n}: {:?}", robot.collisions.first());
    }
}
