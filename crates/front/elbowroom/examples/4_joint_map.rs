//! A joint-space map with a moving obstacle: a trolley blocks cells as it passes, and the path is planned again.
//!
//! `cargo run --release -p elbowroom --example 4_joint_map`
#![allow(clippy::print_stdout, reason = "an example prints")]

use std::error::Error;
use std::path::Path;
use std::time::Instant;

use elbowroom::cspace::{CoverMapBuilder, CoverMapSettings, Grid, GridAxis, LayerMap, RemainingJoints};
use elbowroom::planner::{GridPlanner, GridPlannerError, GridPlannerSettings};
use elbowroom::prelude::*;
use elbowroom::proximity::Cuboid;

/// Width of the cells, degrees.
const STEP_DEG: f64 = 4.0;

fn main() -> Result<(), Box<dyn Error>> {
    let urdf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../examples/models/kr125/kr125.urdf");
    let arm = load_robot(&urdf, &LoadOptions::default())?.robot;

    // The axes of the map are the first three joints. The wrist stays at 0; `Swept` would allow for all its values.
    let (lower, upper) = (arm.chain.lower(), arm.chain.upper());
    let axis = |i: usize| {
        let (from, to) = (lower[i].to_degrees(), upper[i].to_degrees());
        // Rounded to a whole number of cells.
        let cells = ((to - from) / STEP_DEG).floor();
        GridAxis::from_degrees(format!("joint_{}", i + 1), from, from + cells * STEP_DEG, STEP_DEG)
    };
    let grid = Grid::new([axis(0)?, axis(1)?, axis(2)?])?;
    let wrist = RemainingJoints::Fixed(&[0.0; 6]);
    let builder = CoverMapBuilder::new(&arm, Pose::IDENTITY, &grid, [0, 1, 2], wrist, CoverMapSettings::default())?;
    println!("{}: {:?} = {} cells of {STEP_DEG}°\n", arm.chain.name(), grid.shape(), grid.cells());

    // A solid is prepared once and placed often. A cell is blocked if any configuration in it may collide.
    let trolley = builder.obstacle(&Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.4, 0.3, 0.6) }))?;
    let mut map = LayerMap::new(&grid);
    let mut planner = GridPlanner::new(&grid, map.occupancy())?;
    let [start, goal] = [-60.0, 60.0].map(|base| [deg(base), deg(-40.0), deg(60.0)]);

    println!("trolley at y  blocked  newly  freed     map    path");
    for step in 0..=8 {
        let y = 3.2 - 0.8 * f64::from(step);
        let in_world = Pose::from_translation(Vec3::new(1.8, y, 0.6));
        let begin = Instant::now();
        let changes = map.set_layer("trolley", builder.layer(&trolley, &in_world)?).clone();
        let map_ms = 1e3 * begin.elapsed().as_secs_f64();
        // The planner updates only the cells that have changed.
        planner.apply(map.occupancy(), &changes)?;
        let begin = Instant::now();
        let path = planner.plan(start, goal, &GridPlannerSettings::default());
        let path_ms = 1e3 * begin.elapsed().as_secs_f64();
        let found = match path {
            Ok(path) => format!("{:.2} rad, {} waypoints, in {path_ms:.1} ms", path.length_rad, path.waypoints.len()),
            Err(e @ (GridPlannerError::NoPath | GridPlannerError::Blocked { .. })) => format!("{e}"),
            Err(e) => return Err(e.into()),
        };
        println!(
            "{y:>10.1} m  {:>7}  {:>5}  {:>5}  {map_ms:>4.1} ms  {found}",
            map.occupancy().blocked(),
            changes.blocked(),
            changes.freed()
        );
    }
    map.remove("trolley");
    println!("\ntrolley gone: {} cells blocked", map.occupancy().blocked());
    Ok(())
}
