//! Planning times and path lengths: 1,000 random pairs of ends in each of three workspaces.
//!
//! `cargo bench -p elbowroom-planner --bench plan_times`
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::{Duration, Instant};

use common::{Random, blocked_point, connected, free_cell, grid_optimum};
use elbowroom_cspace::{CellIndex, ConvexObstacle, Grid, JointMap};
use elbowroom_planner::{
    GridPlanner, GridPlannerSettings, KinematicLimits, MappedJoints, Path, PathProgress, ReplanKind, example,
};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, SceneState, SweepOptions};

type Error = Box<dyn std::error::Error>;

const PAIRS: usize = 1000;
/// One of this many pairs is compared with exhaustive search.
const COMPARED: usize = 50;

fn main() -> Result<(), Error> {
    for (name, obstacles) in example::cells() {
        let grid = example::grid(2.0)?;
        let mut map = JointMap::new(example::ARM, &grid)?;
        map.set_fixed(&obstacles);
        println!("{name}: {} cells, {} blocked", grid.cells(), map.occupancy().blocked());
        let paths = planning(&grid, &map)?;
        exact(&grid, &map, &obstacles, &paths)?;
        replanning(&grid, &mut map, &paths)?;
    }
    Ok(())
}

fn planning(grid: &Grid, map: &JointMap) -> Result<Vec<Path>, Error> {
    let made = Instant::now();
    let mut planner = GridPlanner::new(grid, map.occupancy())?;
    println!("  planner built in {:.2?}", made.elapsed());
    let mut random = Random(1);
    let (mut times, mut searched, mut ratios, mut paths) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut found, mut none, mut wrong, mut direct, mut corners, mut taken) = (0, 0, 0, 0, 0, 0);
    for n in 0..PAIRS {
        let Some((from, to)) = ends(map, &mut random) else { continue };
        let (start, goal) = (grid.center(from), grid.center(to));
        let clock = Instant::now();
        let path = planner.plan(start, goal, &GridPlannerSettings::default());
        times.push(clock.elapsed());
        if path.as_ref().is_ok_and(|path| path.waypoints.len() > 2) {
            searched.extend(times.last().copied());
        }
        taken = planner.expanded_nodes().max(taken);
        let Ok(path) = path else {
            none += 1;
            wrong += usize::from(connected(map.occupancy(), from, to));
            continue;
        };
        found += 1;
        direct += usize::from(path.waypoints.len() == 2);
        corners += path.waypoints.len() - 2;
        wrong += usize::from(blocked_point(grid, map.occupancy(), &path.waypoints, 10_000).is_some());
        if n % COMPARED == 0 && path.waypoints.len() > 2 {
            let scale = [0, 1, 2].map(|i| grid.axes()[i].step());
            ratios.extend(grid_optimum(map.occupancy(), scale, from, to).map(|optimum| path.length_rad / optimum));
        }
        paths.push(path);
    }
    println!(
        "  {found} found ({direct} straight), {none} not connected, {wrong} wrong; corners {corners}, most nodes {taken}"
    );
    println!("  time: {}", spread(&mut times));
    println!("  time where it is not straight: {}", spread(&mut searched));
    let mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
    let worst = ratios.iter().copied().fold(0.0, f64::max);
    println!("  length over the grid optimum, {} not straight: mean {mean:.4}, worst {worst:.4}", ratios.len());
    println!("  memory {:.2} MB", planner.bytes() as f64 / 1e6);
    Ok(paths)
}

/// Checks every path in the exact scene, and times its time parametrization.
fn exact(grid: &Grid, map: &JointMap, obstacles: &[ConvexObstacle], paths: &[Path]) -> Result<(), Error> {
    let scene = example::scene(grid, obstacles)?;
    let (mut checker, state) = (Checker::new(&scene, CheckerOptions::default()), SceneState::new(&scene));
    let planner = GridPlanner::new(grid, map.occupancy())?;
    let joints = MappedJoints { robot: RobotId(0), joints: [0, 1, 2] };
    let [velocity, acceleration, jerk] = [[1.5, 1.5, 2.0], [3.0, 3.0, 5.0], [30.0, 30.0, 50.0]].map(Vec::from);
    let limits = KinematicLimits { velocity, acceleration, jerk };
    let (mut rejected, mut stops, mut checks, mut timings) = (0, 0, Vec::new(), Vec::new());
    for path in paths {
        let clock = Instant::now();
        rejected += usize::from(path.check(&mut checker, &state, joints, &SweepOptions::default()).is_err());
        checks.push(clock.elapsed());
        let clock = Instant::now();
        stops += planner.time_parametrize(path, &limits)?.stops();
        timings.push(clock.elapsed());
    }
    println!("  exact check, {rejected} of {} rejected: {}", paths.len(), spread(&mut checks));
    println!("  time parametrization, {stops} stops: {}", spread(&mut timings));
    Ok(())
}

/// A sphere is added at the wrist's position on the path; the path is replanned, and planned from the start for comparison.
fn replanning(grid: &Grid, map: &mut JointMap, paths: &[Path]) -> Result<(), Error> {
    let settings = GridPlannerSettings::default();
    for radius in [0.05, 0.15] {
        let mut planner = GridPlanner::new(grid, map.occupancy())?;
        let (mut updates, mut replan_times, mut plan_times) = (Vec::new(), Vec::new(), Vec::new());
        let (mut shares, mut lengths, mut kinds, mut lost, mut unequal) = (Vec::new(), Vec::new(), [0; 3], 0, 0);
        for path in paths.iter().filter(|path| path.length_rad > 1.0).take(300) {
            let middle = halfway(path);
            let wrist = example::ARM.joints_in_base(middle)[2];
            map.set_obstacle("intruder", &ConvexObstacle::sphere(wrist, radius)?);
            let here = PathProgress { segment: 0, q: path.waypoints[0] };
            let clock = Instant::now();
            planner.update(map.occupancy())?;
            updates.push(clock.elapsed());
            let goal = path.waypoints[path.waypoints.len() - 1];
            // The first finds the caches cold: they alternate.
            let (replanned, replan_time, planned, plan_time);
            if kinds.iter().sum::<usize>() % 2 == 0 {
                (replanned, replan_time) = timed(|| planner.replan(path, here, &settings));
                (planned, plan_time) = timed(|| planner.plan(here.q, goal, &settings));
            } else {
                (planned, plan_time) = timed(|| planner.plan(here.q, goal, &settings));
                (replanned, replan_time) = timed(|| planner.replan(path, here, &settings));
            }
            unequal += usize::from(replanned.is_ok() != planned.is_ok());
            if let (Ok((replanned, kind)), Ok(planned)) = (replanned, planned) {
                kinds[kind as usize] += 1;
                if kind != ReplanKind::Kept {
                    shares.push(replan_time.as_secs_f64() / plan_time.as_secs_f64());
                    lengths.push(replanned.length_rad / planned.length_rad);
                    replan_times.push(replan_time);
                    plan_times.push(plan_time);
                }
            } else {
                lost += 1;
            }
            map.remove_obstacle("intruder");
            planner.update(map.occupancy())?;
        }
        println!(
            "  a sphere of {radius} m: kept, repaired, replanned {kinds:?}; {lost} without a path, {unequal} unequal"
        );
        println!("    update {}", spread(&mut updates));
        println!("    replan {}", spread(&mut replan_times));
        println!("    plan   {}", spread(&mut plan_times));
        let sum = |times: &[Duration]| times.iter().sum::<Duration>().as_secs_f64();
        shares.sort_by(f64::total_cmp);
        let median = shares.get(shares.len() / 2).copied().unwrap_or_default();
        let mean = lengths.iter().sum::<f64>() / lengths.len().max(1) as f64;
        let worst = lengths.iter().copied().fold(0.0, f64::max);
        println!(
            "    replan over plan: sum {:.3}, median {median:.3}; length over plan: mean {mean:.3}, worst {worst:.3}",
            sum(&replan_times) / sum(&plan_times)
        );
    }
    Ok(())
}

fn timed<T>(run: impl FnOnce() -> T) -> (T, Duration) {
    let clock = Instant::now();
    let result = run();
    (result, clock.elapsed())
}

/// The configuration at half of the length.
fn halfway(path: &Path) -> [f64; 3] {
    let mut left = 0.5 * path.length_rad;
    for w in path.waypoints.windows(2) {
        let far = (0..3).map(|i| (w[0][i] - w[1][i]).powi(2)).sum::<f64>().sqrt();
        if far >= left {
            return [0, 1, 2].map(|i| w[0][i] + (w[1][i] - w[0][i]) * left / far);
        }
        left -= far;
    }
    path.waypoints[0]
}

fn ends(map: &JointMap, random: &mut Random) -> Option<(CellIndex, CellIndex)> {
    free_cell(map.occupancy(), random).zip(free_cell(map.occupancy(), random))
}

/// Median, 99th percentile, largest.
fn spread(times: &mut [Duration]) -> String {
    times.sort_unstable();
    let at =
        |share: f64| times.get((times.len() as f64 * share) as usize).or(times.last()).copied().unwrap_or_default();
    format!("median {:.3?}, p99 {:.3?}, most {:.3?}", at(0.5), at(0.99), at(1.0))
}
