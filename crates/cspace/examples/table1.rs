//! The paper's Table 1 (S2) remade, for its small arm and for one of a KR125's size:
//! `cargo run --release -p elbowroom-cspace --example table1`.
//!
//! To time and blocked cells it adds what the paper lacks: how many configurations that touch lie in free cells (sampled
//! anywhere, behind the base, and in free cells beside blocked ones), and which share of the blocked cells is free in its
//! whole box.

#![allow(clippy::print_stdout, reason = "an example prints")]
#![allow(clippy::unwrap_used, reason = "the numbers are constants")]

#[path = "clock/mod.rs"]
mod clock;
#[path = "../tests/common/mod.rs"]
mod common;

use std::time::Duration;

use clock::best;
use common::{Random, grid, grid_of, misses, needless};
use elbowroom_cspace::{Filler, Grid, Layer, Model, Obstacle, PlanarArm, Table, expand};
use elbowroom_spatial::{Pose, Vec3};

/// Models, and the paper's milliseconds and blocked elements.
const MODELS: [(Model, &str); 7] = [
    (Model::Sphere, "18.7 ms, 2425"),
    (Model::Spheres(2), "94.2 ms, 2335"),
    (Model::Spheres(4), ""),
    (Model::Spheres(8), ""),
    (Model::Box, "126.2 ms, 1982"),
    (Model::Slices, "15.2 ms, 2488"),
    (Model::Exact, ""),
];

fn main() {
    // The solid of the paper's volumes, 60 x 60 x 140 mm; its limits, -30 degrees and 90 degrees, in this crate's angles.
    let solid = cuboid([0.22, 0.08, 0.05], 0.3, [0.03, 0.03, 0.07]);
    let limits = [[-150.0, 150.0], [-40.0, 120.0], [-90.0, 0.0]];
    remake("The paper's arm, 5 degrees", &PlanarArm::PAPER, &grid_of(5.0, limits), &solid, true);
    remake("The paper's arm, 2 degrees", &PlanarArm::PAPER, &grid_of(2.0, limits), &solid, false);
    let solid = cuboid([1.3, 0.4, 0.9], 30f64.to_radians(), [0.25, 0.2, 0.3]);
    remake("An arm of a KR125's size, 2 degrees", &PlanarArm::KR125_SIZED, &grid(2.0), &solid, false);
}

fn cuboid(at: [f64; 3], yaw: f64, half: [f64; 3]) -> Obstacle {
    Obstacle::cuboid(Pose::from_xyz_rpy(at, [0.0, 0.0, yaw]), Vec3::from(half)).unwrap()
}

fn remake(title: &str, arm: &PlanarArm, grid: &Grid, solid: &Obstacle, paper: bool) {
    println!("{title}, {} cells\n", grid.cells());
    println!("| model | ms | blocked | missed | blocked needlessly | paper |\n| --- | --- | --- | --- | --- | --- |");
    let mut filler = Filler::new(*arm, grid).unwrap();
    let (mut layer, mut table) = (Layer::new(), Table::new(grid.shape()));
    let judge = |name: &str, time: Duration, table: &Table, beside: &str| {
        let mut random = Random(0x9e37_79b9_7f4a_7c15);
        let missed = misses(arm, grid, table, solid, (200_000, 200_000), &mut random);
        let share = needless(arm, grid, table, solid, 2000, &mut random) * 100.0;
        let (ms, beside) = (time.as_secs_f64() * 1e3, if paper { beside } else { "" });
        println!("| {name} | {ms:.4} | {} | {missed} | {share:.1} % | {beside} |", table.blocked());
    };
    for (model, beside) in MODELS {
        let time = best(100, || {
            model.fill(&mut filler, solid, &mut layer);
            table.clear();
            table.add(&layer);
        });
        judge(&model.to_string(), time, &table, beside);
    }
    let time = best(1, || table = expand(arm, grid, solid).table);
    judge("expansion from seeds", time, &table, "");
    println!();
}
