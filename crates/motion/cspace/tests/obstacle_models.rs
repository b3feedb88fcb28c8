//! Every obstacle model blocks at least the cells of the obstacle; more spheres never block more; expansion from seeds finds
//! the components of its seeds.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::common::{SampleCounts, Xorshift, grid, grid_of, missed_contacts, needless_share};
use elbowroom_cspace::{
    ConvexObstacle, Grid, Layer, ObstacleModel, OccupancyBitmap, PlanarArm, PlanarMapBuilder, expand_from_seeds,
    spheres_until,
};
use elbowroom_proximity::ConvexHull;
use elbowroom_spatial::{Pose, Vec3};

const ARM: PlanarArm = PlanarArm::KR125_SIZED;

/// The limits of the joint-space paper in this crate's angles: θ2 from −30° above the horizontal to upright and beyond,
/// 90° and more between the links.
fn paper_grid(step_deg: f64) -> Grid {
    grid_of(step_deg, [[-150.0, 150.0], [-40.0, 120.0], [-90.0, 0.0]])
}

fn build(arm: &PlanarArm, grid: &Grid, obstacle: &ConvexObstacle, model: ObstacleModel) -> OccupancyBitmap {
    let mut builder = PlanarMapBuilder::new(*arm, grid).unwrap();
    let (mut layer, mut occupancy) = (Layer::new(), OccupancyBitmap::new(grid.shape()));
    model.build_layer(&mut builder, obstacle, &mut layer);
    assert!(layer.spans().windows(2).all(|w| w[0].row <= w[1].row), "rows ascend");
    occupancy.add(&layer);
    occupancy
}

fn obstacles() -> Vec<ConvexObstacle> {
    let cuboid =
        |at, rpy, half: [f64; 3]| ConvexObstacle::cuboid(Pose::from_xyz_rpy(at, rpy), Vec3::from(half)).unwrap();
    let wedge = [Vec3::ZERO, Vec3::X * 0.6, Vec3::Y * 0.5, Vec3::Z * 0.7, Vec3::new(0.3, 0.4, 0.3)];
    let wedge = Arc::new(ConvexHull::from_points(&wedge).unwrap());
    vec![
        cuboid([1.3, 0.4, 0.9], [0.0, 0.0, 0.52], [0.25, 0.2, 0.3]),
        cuboid([-1.3, 0.2, 1.1], [0.3, 0.2, 0.5], [0.1, 0.4, 0.3]),
        cuboid([0.1, 0.0, 2.0], [0.0, 0.0, 0.2], [0.4, 0.2, 0.1]),
        ConvexObstacle::sphere(Vec3::new(-0.2, 1.2, 0.5), 0.2).unwrap(),
        ConvexObstacle::hull(Pose::from_xyz_rpy([0.9, -0.6, 0.6], [0.5, 0.1, 1.0]), wedge).unwrap(),
    ]
}

const MODELS: [ObstacleModel; 6] = [
    ObstacleModel::Exact,
    ObstacleModel::Slices,
    ObstacleModel::Sphere,
    ObstacleModel::Spheres(2),
    ObstacleModel::Spheres(16),
    ObstacleModel::Box,
];

#[test]
fn no_model_misses_a_contact() {
    let mut random = Xorshift(5);
    for obstacle in &obstacles() {
        for model in MODELS {
            let grid = grid(4.0);
            let occupancy = build(&ARM, &grid, obstacle, model);
            let missed = missed_contacts(
                &ARM,
                &grid,
                &occupancy,
                obstacle,
                SampleCounts { uniform: 3_000, beside: 3_000 },
                &mut random,
            );
            assert_eq!(missed, 0, "{model}: {obstacle:?}");
        }
    }
}

#[test]
fn no_model_misses_a_contact_of_the_papers_arm() {
    let mut random = Xorshift(6);
    let cube =
        ConvexObstacle::cuboid(Pose::from_xyz_rpy([0.22, 0.08, 0.05], [0.0, 0.0, 0.3]), Vec3::splat(0.04)).unwrap();
    let grid = paper_grid(5.0);
    for model in MODELS {
        let occupancy = build(&PlanarArm::PAPER, &grid, &cube, model);
        let missed = missed_contacts(
            &PlanarArm::PAPER,
            &grid,
            &occupancy,
            &cube,
            SampleCounts { uniform: 5_000, beside: 5_000 },
            &mut random,
        );
        let share = needless_share(&PlanarArm::PAPER, &grid, &occupancy, &cube, 2000, &mut random);
        println!("{model}: {} blocked, {:.1} % needlessly", occupancy.blocked(), share * 100.0);
        assert_eq!(missed, 0, "{model}");
        assert!(model != ObstacleModel::Exact || share <= 0.01, "{share}");
    }
}

#[test]
fn more_spheres_never_block_more() {
    let grid = grid(5.0);
    for obstacle in &obstacles() {
        let mut before: Option<OccupancyBitmap> = None;
        for count in [1, 2, 4, 8, 16, 32] {
            let occupancy = build(&ARM, &grid, obstacle, ObstacleModel::Spheres(count));
            if let Some(before) = before {
                assert!(occupancy.iter().all(|cell| before.is_blocked(cell)), "{count}");
            }
            before = Some(occupancy);
        }
    }
}

#[test]
fn a_deadline_in_the_past_still_gives_one_sphere() {
    let grid = grid(5.0);
    let mut builder = PlanarMapBuilder::new(ARM, &grid).unwrap();
    let (mut layer, mut single) = (Layer::new(), Layer::new());
    let obstacle = &obstacles()[0];
    assert_eq!(spheres_until(&mut builder, obstacle, 64, Some(Instant::now()), &mut layer), 1);
    ObstacleModel::Sphere.build_layer(&mut builder, obstacle, &mut single);
    assert_eq!(layer, single);
    let soon = Instant::now() + Duration::from_secs(20);
    assert_eq!(spheres_until(&mut builder, obstacle, 8, Some(soon), &mut layer), 8);
}

#[test]
fn expansion_finds_the_components_of_its_seeds() {
    let mut random = Xorshift(8);
    let grid = grid(6.0);
    for obstacle in [&obstacles()[0], &obstacles()[3]] {
        let expansion = expand_from_seeds(&ARM, &grid, obstacle);
        let exact = build(&ARM, &grid, obstacle, ObstacleModel::Exact);
        let missed = missed_contacts(
            &ARM,
            &grid,
            &expansion.occupancy,
            obstacle,
            SampleCounts { uniform: 5_000, beside: 5_000 },
            &mut random,
        );
        println!(
            "seeds {}, tested {}, filled {}, blocked {} (exact {})",
            expansion.seeds,
            expansion.tested,
            expansion.filled,
            expansion.occupancy.blocked(),
            exact.blocked()
        );
        assert_eq!(missed, 0);
        assert!(expansion.filled > 0 && expansion.tested < grid.cells());
    }
}
