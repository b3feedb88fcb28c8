//! How long planning takes, and how good paths are: 1,000 random pairs of ends in each of three cells.
//!
//! `cargo run --release -p elbowroom-planner --example plan_times`
#![allow(clippy::print_stdout)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::time::{Duration, Instant};

use common::{Random, blocked_point, free_cell, grid_optimum, joined};
use elbowroom_cspace::{Axis, Cell, Grid, JointMap, Obstacle, PlanarArm};
use elbowroom_planner::{PlanOptions, Planner};
use elbowroom_spatial::{Pose, Vec3};

type Error = Box<dyn std::error::Error>;

const PAIRS: usize = 1000;
/// Every so many pairs the exhaustive search for the shortest way is asked.
const JUDGED: usize = 50;

fn main() -> Result<(), Error> {
    for (name, obstacles) in cells()? {
        let axis = |name: &str, min, max| Axis::from_degrees(name, min, max, 2.0);
        let axes = [axis("base", -170.0, 170.0)?, axis("shoulder", -90.0, 90.0)?, axis("elbow", -120.0, 150.0)?];
        let grid = Grid::new(axes)?;
        let mut map = JointMap::new(PlanarArm::KR125_SIZED, &grid)?;
        map.set_fixed(&obstacles);
        println!("{name}: {} cells, {} blocked", grid.cells(), map.table().blocked());
        planning(&grid, &map)?;
    }
    Ok(())
}

fn ball(x: f64, y: f64, z: f64, radius: f64) -> Result<Obstacle, Error> {
    Ok(Obstacle::sphere(Vec3::new(x, y, z), radius)?)
}

fn cuboid(at: [f64; 3], yaw: f64, half: [f64; 3]) -> Result<Obstacle, Error> {
    Ok(Obstacle::cuboid(Pose::from_xyz_rpy(at, [0.0, 0.0, yaw]), Vec3::from(half))?)
}

fn cells() -> Result<Vec<(&'static str, Vec<Obstacle>)>, Error> {
    let floor = || cuboid([0.0, 0.0, -0.6], 0.0, [3.0, 3.0, 0.1]);
    Ok(vec![
        ("one ball", vec![ball(1.3, 0.4, 0.9, 0.3)?]),
        (
            "floor, table, two posts",
            vec![
                floor()?,
                cuboid([1.5, 0.0, 0.2], 0.3, [0.4, 0.6, 0.05])?,
                cuboid([1.2, -1.2, 1.0], 0.0, [0.08, 0.08, 1.5])?,
                cuboid([-0.2, 1.6, 1.0], 0.0, [0.08, 0.08, 1.5])?,
            ],
        ),
        (
            "walls with gaps, a beam overhead, balls",
            vec![
                floor()?,
                cuboid([1.5, 0.5, 0.3], 0.4, [0.7, 0.04, 0.9])?,
                cuboid([1.5, -0.7, 1.6], -0.5, [0.7, 0.04, 0.7])?,
                cuboid([-0.9, 0.9, 0.8], 2.3, [0.5, 0.04, 1.4])?,
                cuboid([0.0, 0.0, 2.9], 0.7, [3.0, 0.1, 0.1])?,
                ball(1.7, -0.1, 1.3, 0.15)?,
                ball(-1.2, -1.0, 1.0, 0.4)?,
                ball(0.3, 1.7, 0.4, 0.2)?,
            ],
        ),
    ])
}

fn planning(grid: &Grid, map: &JointMap) -> Result<(), Error> {
    let made = Instant::now();
    let mut planner = Planner::new(grid, map.table())?;
    println!("  planner made in {:.2?}", made.elapsed());
    let mut random = Random(1);
    let (mut times, mut ratios) = (Vec::new(), Vec::new());
    let (mut found, mut none, mut wrong, mut direct, mut corners, mut taken) = (0, 0, 0, 0, 0, 0);
    for n in 0..PAIRS {
        let Some((from, to)) = ends(map, &mut random) else { continue };
        let (start, goal) = (grid.center(from), grid.center(to));
        let clock = Instant::now();
        let path = planner.plan(start, goal, &PlanOptions::default());
        times.push(clock.elapsed());
        taken = planner.taken().max(taken);
        let Ok(path) = path else {
            none += 1;
            wrong += usize::from(joined(map.table(), from, to));
            continue;
        };
        found += 1;
        direct += usize::from(path.waypoints.len() == 2);
        corners += path.waypoints.len() - 2;
        wrong += usize::from(blocked_point(grid, map.table(), &path.waypoints, 10_000).is_some());
        if n % JUDGED == 0 && path.waypoints.len() > 2 {
            let scale = [0, 1, 2].map(|i| grid.axes()[i].step());
            ratios.extend(grid_optimum(map.table(), scale, from, to).map(|optimum| path.length_rad / optimum));
        }
    }
    println!(
        "  {found} found ({direct} straight), {none} not joined, {wrong} wrong; corners {corners}, most nodes {taken}"
    );
    println!("  time: {}", spread(&mut times));
    let mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
    let worst = ratios.iter().copied().fold(0.0, f64::max);
    println!("  length over the grid optimum, {} not straight: mean {mean:.4}, worst {worst:.4}", ratios.len());
    println!("  memory {:.2} MB", planner.bytes() as f64 / 1e6);
    Ok(())
}

fn ends(map: &JointMap, random: &mut Random) -> Option<(Cell, Cell)> {
    free_cell(map.table(), random).zip(free_cell(map.table(), random))
}

/// Median, 99th percentile, largest.
fn spread(times: &mut [Duration]) -> String {
    times.sort_unstable();
    let at =
        |share: f64| times.get((times.len() as f64 * share) as usize).or(times.last()).copied().unwrap_or_default();
    format!("median {:.3?}, p99 {:.3?}, most {:.3?}", at(0.5), at(0.99), at(1.0))
}
