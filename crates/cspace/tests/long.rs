//! A million configurations each; run with `cargo test --release -p elbowroom-cspace --test long -- --ignored`.

mod common;

use common::{Random, grid, grid_of, misses};
use elbowroom_cspace::{Filler, Grid, Layer, Model, Obstacle, PlanarArm, Table};
use elbowroom_spatial::{Pose, Vec3};

fn count(arm: &PlanarArm, grid: &Grid, obstacle: &Obstacle, model: Model) -> usize {
    let mut filler = Filler::new(*arm, grid).unwrap();
    let (mut layer, mut table) = (Layer::new(), Table::new(grid.shape()));
    model.fill(&mut filler, obstacle, &mut layer);
    table.add(&layer);
    misses(arm, grid, &table, obstacle, (1_000_000, 1_000_000), &mut Random(0x1234_5678_9abc_def1))
}

#[test]
#[ignore = "half a minute; cargo test --release -p elbowroom-cspace --test long -- --ignored"]
fn a_million_configurations_of_the_large_arm() {
    let cuboid = |at, rpy| Obstacle::cuboid(Pose::from_xyz_rpy(at, rpy), Vec3::new(0.25, 0.2, 0.3)).unwrap();
    let obstacles = [
        Obstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25).unwrap(),
        cuboid([1.3, 0.4, 0.9], [0.0, 0.0, 30f64.to_radians()]),
        cuboid([1.3, 0.4, 0.9], [0.4, 0.7, 0.5]),
        cuboid([0.1, -0.1, 2.0], [0.4, 0.7, 0.5]),
        cuboid([-1.2, 0.3, 1.4], [0.2, 0.1, 0.9]),
    ];
    for obstacle in &obstacles {
        for step in [2.0, 1.0] {
            assert_eq!(count(&PlanarArm::KR125_SIZED, &grid(step), obstacle, Model::Exact), 0, "{step}: {obstacle:?}");
        }
        for model in [Model::Slices, Model::Sphere, Model::Spheres(8), Model::Box] {
            assert_eq!(count(&PlanarArm::KR125_SIZED, &grid(2.0), obstacle, model), 0, "{model}: {obstacle:?}");
        }
    }
}

#[test]
#[ignore = "half a minute; cargo test --release -p elbowroom-cspace --test long -- --ignored"]
fn a_million_configurations_of_the_papers_arm() {
    let at = Pose::from_xyz_rpy([0.22, 0.08, 0.05], [0.0, 0.0, 0.3]);
    let cube = Obstacle::cuboid(at, Vec3::splat(0.04)).unwrap();
    let ranges = [[-150.0, 150.0], [-40.0, 120.0], [-90.0, 0.0]];
    for step in [5.0, 2.0] {
        for model in [Model::Exact, Model::Slices, Model::Sphere, Model::Spheres(8), Model::Box] {
            assert_eq!(count(&PlanarArm::PAPER, &grid_of(step, ranges), &cube, model), 0, "{step}, {model}");
        }
    }
}
