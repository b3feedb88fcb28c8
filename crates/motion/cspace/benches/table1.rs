//! Reproduces table 1 of the joint-space paper for its small arm and for an arm of a KR125's size:
//! `cargo bench -p elbowroom-cspace --bench table1`.
//!
//! In addition to times and blocked cells, it prints the number of collisions in free cells (sampled anywhere, behind
//! the base, and in free neighbours of blocked cells) and the fraction of blocked cells that are free in their whole
//! box.

#![allow(clippy::print_stdout, reason = "a bench prints")]
#![allow(clippy::unwrap_used, reason = "the numbers are constants")]

#[path = "clock/mod.rs"]
mod clock;
#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Duration;

use clock::best;
use common::{SampleCounts, Xorshift, grid, grid_of, missed_contacts, needless_share};
use elbowroom_cspace::{
    ConvexObstacle, Grid, Layer, ObstacleModel, OccupancyBitmap, PlanarArm, PlanarMapBuilder, expand_from_seeds,
};
use elbowroom_spatial::{Pose, Vec3};

/// Models, and the paper's milliseconds and blocked elements.
const MODELS: [(ObstacleModel, &str); 7] = [
    (ObstacleModel::Sphere, "18.7 ms, 2425"),
    (ObstacleModel::Spheres(2), "94.2 ms, 2335"),
    (ObstacleModel::Spheres(4), ""),
    (ObstacleModel::Spheres(8), ""),
    (ObstacleModel::Box, "126.2 ms, 1982"),
    (ObstacleModel::Slices, "15.2 ms, 2488"),
    (ObstacleModel::Exact, ""),
];

fn main() {
    // The solid of the paper's volumes, 60 x 60 x 140 mm; its limits, -30 degrees and 90 degrees, in this crate's
    // angles.
    let solid = cuboid([0.22, 0.08, 0.05], 0.3, [0.03, 0.03, 0.07]);
    let limits = [[-150.0, 150.0], [-40.0, 120.0], [-90.0, 0.0]];
    reproduce("The paper's arm, 5 degrees", &PlanarArm::PAPER, &grid_of(5.0, limits), &solid, true);
    reproduce("The paper's arm, 2 degrees", &PlanarArm::PAPER, &grid_of(2.0, limits), &solid, false);
    let solid = cuboid([1.3, 0.4, 0.9], 30f64.to_radians(), [0.25, 0.2, 0.3]);
    reproduce("An arm of a KR125's size, 2 degrees", &PlanarArm::KR125_SIZED, &grid(2.0), &solid, false);
}

fn cuboid(at: [f64; 3], yaw: f64, half: [f64; 3]) -> ConvexObstacle {
    ConvexObstacle::cuboid(Pose::from_xyz_rpy(at, [0.0, 0.0, yaw]), Vec3::from(half)).unwrap()
}

fn reproduce(title: &str, arm: &PlanarArm, grid: &Grid, solid: &ConvexObstacle, paper: bool) {
    println!("{title}, {} cells\n", grid.cells());
    println!("| model | ms | blocked | missed | blocked needlessly | paper |\n| --- | --- | --- | --- | --- | --- |");
    let mut builder = PlanarMapBuilder::new(*arm, grid).unwrap();
    let (mut layer, mut occupancy) = (Layer::new(), OccupancyBitmap::new(grid.shape()));
    let print = |name: &str, time: Duration, occupancy: &OccupancyBitmap, beside: &str| {
        let mut random = Xorshift(0x9e37_79b9_7f4a_7c15);
        let samples = SampleCounts { uniform: 200_000, beside: 200_000 };
        let missed = missed_contacts(arm, grid, occupancy, solid, samples, &mut random);
        let share = needless_share(arm, grid, occupancy, solid, 2000, &mut random) * 100.0;
        let (ms, beside) = (time.as_secs_f64() * 1e3, if paper { beside } else { "" });
        println!("| {name} | {ms:.4} | {} | {missed} | {share:.1} % | {beside} |", occupancy.blocked());
    };
    for (model, beside) in MODELS {
        let time = best(100, || {
            model.build_layer(&mut builder, solid, &mut layer);
            occupancy.clear();
            occupancy.add(&layer);
        });
        print(&model.to_string(), time, &occupancy, beside);
    }
    let time = best(1, || occupancy = expand_from_seeds(arm, grid, solid).occupancy);
    print("expansion from seeds", time, &occupancy, "");
    println!();
}
