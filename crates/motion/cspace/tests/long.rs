//! A million configurations each; run with `cargo test --release -p elbowroom-cspace --test main long:: -- --ignored`.

use crate::common::{SampleCounts, Xorshift, grid, grid_of, missed_contacts};
use elbowroom_cspace::{ConvexObstacle, Grid, Layer, ObstacleModel, OccupancyBitmap, PlanarArm, PlanarMapBuilder};
use elbowroom_spatial::{Pose, Vec3};

fn count(arm: &PlanarArm, grid: &Grid, obstacle: &ConvexObstacle, model: ObstacleModel) -> usize {
    let mut builder = PlanarMapBuilder::new(*arm, grid).unwrap();
    let (mut layer, mut occupancy) = (Layer::new(), OccupancyBitmap::new(grid.shape()));
    model.build_layer(&mut builder, obstacle, &mut layer);
    occupancy.add(&layer);
    missed_contacts(
        arm,
        grid,
        &occupancy,
        obstacle,
        SampleCounts { uniform: 1_000_000, beside: 1_000_000 },
        &mut Xorshift(0x1234_5678_9abc_def1),
    )
}

#[test]
#[ignore = "half a minute; cargo test --release -p elbowroom-cspace --test main long:: -- --ignored"]
fn a_million_configurations_of_the_large_arm() {
    let cuboid = |at, rpy| ConvexObstacle::cuboid(Pose::from_xyz_rpy(at, rpy), Vec3::new(0.25, 0.2, 0.3)).unwrap();
    let obstacles = [
        ConvexObstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25).unwrap(),
        cuboid([1.3, 0.4, 0.9], [0.0, 0.0, 30f64.to_radians()]),
        cuboid([1.3, 0.4, 0.9], [0.4, 0.7, 0.5]),
        cuboid([0.1, -0.1, 2.0], [0.4, 0.7, 0.5]),
        cuboid([-1.2, 0.3, 1.4], [0.2, 0.1, 0.9]),
    ];
    for obstacle in &obstacles {
        for step in [2.0, 1.0] {
            assert_eq!(
                count(&PlanarArm::KR125_SIZED, &grid(step), obstacle, ObstacleModel::Exact),
                0,
                "{step}: {obstacle:?}"
            );
        }
        for model in [ObstacleModel::Slices, ObstacleModel::Sphere, ObstacleModel::Spheres(8), ObstacleModel::Box] {
            assert_eq!(count(&PlanarArm::KR125_SIZED, &grid(2.0), obstacle, model), 0, "{model}: {obstacle:?}");
        }
    }
}

#[test]
#[ignore = "half a minute; cargo test --release -p elbowroom-cspace --test main long:: -- --ignored"]
fn a_million_configurations_of_the_papers_arm() {
    let at = Pose::from_xyz_rpy([0.22, 0.08, 0.05], [0.0, 0.0, 0.3]);
    let cube = ConvexObstacle::cuboid(at, Vec3::splat(0.04)).unwrap();
    let ranges = [[-150.0, 150.0], [-40.0, 120.0], [-90.0, 0.0]];
    for step in [5.0, 2.0] {
        for model in [
            ObstacleModel::Exact,
            ObstacleModel::Slices,
            ObstacleModel::Sphere,
            ObstacleModel::Spheres(8),
            ObstacleModel::Box,
        ] {
            assert_eq!(count(&PlanarArm::PAPER, &grid_of(step, ranges), &cube, model), 0, "{step}, {model}");
        }
    }
}
