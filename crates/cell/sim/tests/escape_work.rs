//! The hardest of the runs of `cargo xtask evade`: no hit, and no step longer than a tick in counted work.
#![allow(clippy::print_stdout)]

use crate::common::crossing;
use std::path::Path;

use elbowroom_cell::{Cell, Drive};
use elbowroom_robot::ObjectId;
use elbowroom_sim::RunOptions;
use elbowroom_sim::run::simulate;

/// Runs that hit before escapes were kept known, or that need most of them.
const HARD: [usize; 2] = [135, 160];

#[test]
fn hard_runs_do_not_hit() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/evade.toml");
    let cell = Cell::load(file).unwrap();
    let moves = |o: &ObjectId| cell.moving_objects.iter().any(|m| m.object == *o);
    let object = cell.avoidance[0].as_ref().unwrap().objects.iter().copied().find(moves).unwrap();
    let seconds = crossing::without_obstacle(&cell).unwrap().duration_s;
    let only = std::env::var("ELBOWROOM_EVADE_RUNS").ok();
    let runs: Vec<usize> = only.map_or(HARD.to_vec(), |o| o.split(',').map(|n| n.trim().parse().unwrap()).collect());
    let paths = crossing::paths(&cell, object, seconds, runs.iter().max().unwrap() + 1).unwrap();
    for n in runs {
        let mut cell = cell.clone();
        cell.moving_objects.iter_mut().find(|m| m.object == object).unwrap().drive = Drive::Path(paths[n].clone());
        let recording = simulate(&cell, &RunOptions::default()).unwrap().recording;
        let robot = &recording.robots[0];
        let s = &robot.avoidance.as_ref().unwrap().samples;
        let near: Vec<f64> =
            s.iter().enumerate().filter(|(_, s)| s.nearest_m < 0.3).map(|(i, _)| i as f64 * cell.tick_s).collect();
        let least = s.iter().enumerate().min_by(|a, b| a.1.nearest_m.total_cmp(&b.1.nearest_m)).unwrap();
        let off: Vec<f64> = s
            .iter()
            .enumerate()
            .filter(|(_, s)| s.path_deviation_s > 0.0)
            .map(|(i, _)| i as f64 * cell.tick_s)
            .collect();
        println!(
            "CAL {n}: near {:?}..{:?}, least {} at {}, off {:?}..{:?}",
            near.first(),
            near.last(),
            least.1.nearest_m,
            least.0 as f64 * cell.tick_s,
            off.first(),
            off.last()
        );
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
        assert!(robot.collisions.is_empty(), "run {n}: {:?}", robot.collisions.first());
    }
}
