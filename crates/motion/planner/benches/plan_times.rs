//! Planning times and path lengths: 1,000 random pairs of ends in each of three workspaces.
//!
//! `cargo bench -p elbowroom-planner --bench plan_times`
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use elbowroom_kinematics::JointLimits;
use std::time::{Duration, Instant};

use common::{Random, blocked_point, connected, free_cell, grid_optimum};
use elbowroom_cspace::{CellIndex, ConvexObstacle, Grid, JointMap};
use elbowroom_planner::{GridPath, GridPlanner, GridPlannerSettings, example};

type Error = Box<dyn std::error::Error>;

const PAIRS: usize = 1000;
/// Number of pairs of which one is compared with exhaustive search.
const COMPARED: usize = 50;

fn main() -> Result<(), Error> {
    for (name, obstacles) in example::cells() {
        let grid = example::grid(2.0)?;
        let mut map = JointMap::new(example::ARM, &grid)?;
        map.set_fixed(&obstacles);
        println!("{name}: {} cells, {} blocked", grid.cells(), map.occupancy().blocked());
        let paths = planning(&grid, &map)?;
        timing(&grid, &map, &paths)?;
        replanning(&grid, &mut map, &paths)?;
    }
    Ok(())
}

fn planning(grid: &Grid, map: &JointMap) -> Result<Vec<GridPath>, Error> {
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

/// Times the time parametrization of every path.
fn timing(grid: &Grid, map: &JointMap, paths: &[GridPath]) -> Result<(), Error> {
    let planner = GridPlanner::new(grid, map.occupancy())?;
    let limits = [[1.5, 3.0, 30.0], [1.5, 3.0, 30.0], [2.0, 5.0, 50.0]].map(|[v, a, j]| JointLimits::new(v, a, j));
    let (mut stops, mut timings) = (0, Vec::new());
    for path in paths {
        let clock = Instant::now();
        stops += planner.time_parametrize(path, &limits)?.stops();
        timings.push(clock.elapsed());
    }
    println!("  time parametrization, {stops} stops: {}", spread(&mut timings));
    Ok(())
}

/// Adds a sphere at the wrist's position on the path, and plans the path again.
fn replanning(grid: &Grid, map: &mut JointMap, paths: &[GridPath]) -> Result<(), Error> {
    let settings = GridPlannerSettings::default();
    for radius in [0.05, 0.15] {
        let mut planner = GridPlanner::new(grid, map.occupancy())?;
        let (mut updates, mut plan_times, mut lost) = (Vec::new(), Vec::new(), 0);
        for path in paths.iter().filter(|path| path.length_rad > 1.0).take(300) {
            let wrist = example::ARM.joints_in_base(halfway(path))[2];
            map.set_obstacle("intruder", &ConvexObstacle::sphere(wrist, radius)?);
            let clock = Instant::now();
            planner.update(map.occupancy())?;
            updates.push(clock.elapsed());
            let [from, goal] = [path.waypoints[0], path.waypoints[path.waypoints.len() - 1]];
            let clock = Instant::now();
            lost += usize::from(planner.plan(from, goal, &settings).is_err());
            plan_times.push(clock.elapsed());
            map.remove_obstacle("intruder");
            planner.update(map.occupancy())?;
        }
        println!("  a sphere of {radius} m: {lost} without a path");
        println!("    update {}", spread(&mut updates));
        println!("    plan   {}", spread(&mut plan_times));
    }
    Ok(())
}

/// The configuration at half of the path's length.
fn halfway(path: &GridPath) -> [f64; 3] {
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

/// Formats median, 99th percentile and largest time.
fn spread(times: &mut [Duration]) -> String {
    times.sort_unstable();
    let at =
        |share: f64| times.get((times.len() as f64 * share) as usize).or(times.last()).copied().unwrap_or_default();
    format!("median {:.3?}, p99 {:.3?}, most {:.3?}", at(0.5), at(0.99), at(1.0))
}
