//! Growth of the trees of RRT-Connect: time and memory with the number of nodes; allocations of a plan.
//!
//! `cargo bench -p elbowroom-planner --bench growth`: an RX60B below a ceiling, between two walls that leave no path, so that the
//! search ends at its limit of checked states.

#![allow(clippy::print_stdout, reason = "a bench prints")]

use std::error::Error;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_planner::{CoverModel, CoverObstacles, CoverRrtConnect, RrtConnect, RrtConnectError, RrtConnectSettings};
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Object, Scene, SceneState};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};
use elbowroom_testkit::bench::{GrowthTable, Stopwatch};
use elbowroom_testkit::folder::model;

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

const ROBOT: RobotId = RobotId(0);
const START: [f64; 6] = [1.57, 1.7, 0.2, 0.0, 0.3, 0.0];
const GOAL: [f64; 6] = [-1.57, 1.7, 0.2, 0.0, 0.3, 0.0];

fn main() -> Result<()> {
    nodes(&scene(&[("ceiling", 0.61), ("wall", 0.0)])?)?;
    plan_allocations(&scene(&[("wall", 0.0)])?)
}

/// An arm with a ceiling and walls on either side.
fn scene(parts: &[(&str, f64)]) -> Result<Scene> {
    let urdf = model("rx60b");
    let options = LoadOptions { srdf: Some(urdf.with_extension("srdf")), ..LoadOptions::default() };
    let mut builder = Scene::builder();
    builder.robot("arm", load(&urdf, &options)?.robot, Pose::IDENTITY);
    let mut add = |name: &str, at: Vec3, half_extents: Vec3| {
        let shape = Shape::Cuboid(Cuboid { half_extents });
        builder.object(Object { name: name.into(), shape, in_world: Pose::from_translation(at) });
    };
    for &(name, height_m) in parts {
        if name == "ceiling" {
            add(name, Vec3::Z * height_m, Vec3::new(1.5, 1.5, 0.01));
        } else {
            add("left wall", Vec3::new(0.9, 0.0, 0.4), Vec3::new(0.68, 0.01, 0.2));
            add("right wall", Vec3::new(-0.9, 0.0, 0.4), Vec3::new(0.68, 0.01, 0.2));
        }
    }
    Ok(builder.build()?)
}

fn nodes(scene: &Scene) -> Result<()> {
    let columns = ["nodes", "states checked", "search s", "µs/node", "B/node"];
    let table = GrowthTable::start("nodes of the planner's trees", &columns);
    let mut start = SceneState::new(scene);
    start.set_q(scene, ROBOT, &START)?;
    for max_states in [3_000, 10_000, 30_000, 100_000, 300_000, 1_000_000] {
        let settings = RrtConnectSettings { max_states, time_limit: Duration::from_mins(2), ..Default::default() };
        let mut planner = RrtConnect::new(scene, ROBOT)?;
        let watch = Stopwatch::start();
        let (found, most_bytes) = with_peak(|| planner.plan(&start, &GOAL, &settings));
        let seconds = watch.seconds();
        let Err(RrtConnectError::NotFound { states_checked, nodes, .. }) = found else {
            return Err(format!("the walls leave no path, but: {found:?}").into());
        };
        let n = nodes as f64;
        table.row(&[n, states_checked as f64, seconds, seconds / n * 1e6, most_bytes / n]);
    }
    Ok(())
}

/// Runs a task, and samples how many bytes it holds at most.
fn with_peak<R>(task: impl FnOnce() -> R) -> (R, f64) {
    let (counter, is_done) = (AllocationCounter::start(), AtomicBool::new(false));
    std::thread::scope(|scope| {
        let sampler = scope.spawn(|| {
            let mut most = 0;
            while !is_done.load(Ordering::Relaxed) {
                most = most.max(counter.held_bytes());
                std::thread::sleep(Duration::from_micros(500));
            }
            most
        });
        let result = task();
        is_done.store(true, Ordering::Relaxed);
        (result, sampler.join().map_or(0.0, |most| most as f64))
    })
}

fn plan_allocations(scene: &Scene) -> Result<()> {
    let mut start = SceneState::new(scene);
    start.set_q(scene, ROBOT, &START)?;
    let model = CoverModel::new(scene, &start, ROBOT, 0.0)?;
    let obstacles = CoverObstacles::new(&model, scene, &start, 0.0);
    let mut planner = CoverRrtConnect::new(RrtConnect::new(scene, ROBOT)?, &model, &obstacles);
    println!("\nallocations of a plan, seeds 1 to 5: first and second time, states checked");
    for seed in 1..=5 {
        let settings = RrtConnectSettings { seed, ..Default::default() };
        let mut plan = || -> Result<(usize, u64)> {
            let counter = AllocationCounter::start();
            let path = planner.plan(&start, &GOAL, &settings)?;
            Ok((counter.allocations(), path.states_checked))
        };
        let ((first, _), (second, states)) = (plan()?, plan()?);
        println!("{first:8} {second:8} {states:8}");
    }
    Ok(())
}
