//! Every obstacle model blocks at least what the obstacle does; more spheres never block more; the paper's expansion finds
//! what its seeds lead to.

mod common;

use std::sync::Arc;
use std::time::{Duration, Instant};

use common::{Random, grid, grid_of, misses, needless};
use elbowroom_cspace::{Filler, Grid, Layer, Model, Obstacle, PlanarArm, Table, expand, spheres_until};
use elbowroom_proximity::ConvexHull;
use elbowroom_spatial::{Pose, Vec3};

const ARM: PlanarArm = PlanarArm::KR125_SIZED;

/// The paper's limits, in this crate's angles: θ2 from −30° above the horizontal to upright and beyond, 90° and more
/// between the links.
fn paper_grid(step_deg: f64) -> Grid {
    grid_of(step_deg, [[-150.0, 150.0], [-40.0, 120.0], [-90.0, 0.0]])
}

fn tables(arm: &PlanarArm, grid: &Grid, obstacle: &Obstacle, model: Model) -> Table {
    let mut filler = Filler::new(*arm, grid).unwrap();
    let (mut layer, mut table) = (Layer::new(), Table::new(grid.shape()));
    model.fill(&mut filler, obstacle, &mut layer);
    assert!(layer.spans().windows(2).all(|w| w[0].row <= w[1].row), "rows ascend");
    table.add(&layer);
    table
}

fn obstacles() -> Vec<Obstacle> {
    let cuboid = |at, rpy, half: [f64; 3]| Obstacle::cuboid(Pose::from_xyz_rpy(at, rpy), Vec3::from(half)).unwrap();
    let wedge = [Vec3::ZERO, Vec3::X * 0.6, Vec3::Y * 0.5, Vec3::Z * 0.7, Vec3::new(0.3, 0.4, 0.3)];
    let wedge = Arc::new(ConvexHull::from_points(&wedge).unwrap());
    vec![
        cuboid([1.3, 0.4, 0.9], [0.0, 0.0, 0.52], [0.25, 0.2, 0.3]),
        cuboid([-1.3, 0.2, 1.1], [0.3, 0.2, 0.5], [0.1, 0.4, 0.3]),
        cuboid([0.1, 0.0, 2.0], [0.0, 0.0, 0.2], [0.4, 0.2, 0.1]),
        Obstacle::sphere(Vec3::new(-0.2, 1.2, 0.5), 0.2).unwrap(),
        Obstacle::hull(Pose::from_xyz_rpy([0.9, -0.6, 0.6], [0.5, 0.1, 1.0]), wedge).unwrap(),
    ]
}

const MODELS: [Model; 6] =
    [Model::Exact, Model::Slices, Model::Sphere, Model::Spheres(2), Model::Spheres(16), Model::Box];

#[test]
fn no_model_misses_a_configuration_that_touches() {
    let mut random = Random(5);
    for obstacle in &obstacles() {
        for model in MODELS {
            let grid = grid(4.0);
            let table = tables(&ARM, &grid, obstacle, model);
            let missed = misses(&ARM, &grid, &table, obstacle, (3_000, 3_000), &mut random);
            assert_eq!(missed, 0, "{model}: {obstacle:?}");
        }
    }
}

#[test]
fn on_the_papers_arm_too() {
    let mut random = Random(6);
    let cube = Obstacle::cuboid(Pose::from_xyz_rpy([0.22, 0.08, 0.05], [0.0, 0.0, 0.3]), Vec3::splat(0.04)).unwrap();
    let grid = paper_grid(5.0);
    for model in MODELS {
        let table = tables(&PlanarArm::PAPER, &grid, &cube, model);
        let missed = misses(&PlanarArm::PAPER, &grid, &table, &cube, (5_000, 5_000), &mut random);
        let share = needless(&PlanarArm::PAPER, &grid, &table, &cube, 2000, &mut random);
        println!("{model}: {} blocked, {:.1} % needlessly", table.blocked(), share * 100.0);
        assert_eq!(missed, 0, "{model}");
        assert!(model != Model::Exact || share <= 0.01, "{share}");
    }
}

#[test]
fn more_spheres_never_block_more() {
    let grid = grid(5.0);
    for obstacle in &obstacles() {
        let mut before: Option<Table> = None;
        for count in [1, 2, 4, 8, 16, 32] {
            let table = tables(&ARM, &grid, obstacle, Model::Spheres(count));
            if let Some(before) = before {
                assert!(table.iter().all(|cell| before.is_blocked(cell)), "{count}");
            }
            before = Some(table);
        }
    }
}

#[test]
fn a_deadline_in_the_past_still_gives_one_sphere() {
    let grid = grid(5.0);
    let mut filler = Filler::new(ARM, &grid).unwrap();
    let (mut layer, mut single) = (Layer::new(), Layer::new());
    let obstacle = &obstacles()[0];
    assert_eq!(spheres_until(&mut filler, obstacle, 64, Some(Instant::now()), &mut layer), 1);
    Model::Sphere.fill(&mut filler, obstacle, &mut single);
    assert_eq!(layer, single);
    let soon = Instant::now() + Duration::from_secs(20);
    assert_eq!(spheres_until(&mut filler, obstacle, 8, Some(soon), &mut layer), 8);
}

#[test]
fn the_papers_expansion_finds_what_its_seeds_lead_to() {
    let mut random = Random(8);
    let grid = grid(6.0);
    for obstacle in [&obstacles()[0], &obstacles()[3]] {
        let expansion = expand(&ARM, &grid, obstacle);
        let exact = tables(&ARM, &grid, obstacle, Model::Exact);
        let missed = misses(&ARM, &grid, &expansion.table, obstacle, (5_000, 5_000), &mut random);
        println!(
            "seeds {}, tested {}, filled {}, blocked {} (exact {})",
            expansion.seeds,
            expansion.tested,
            expansion.filled,
            expansion.table.blocked(),
            exact.blocked()
        );
        assert_eq!(missed, 0);
        assert!(expansion.filled > 0 && expansion.tested < grid.cells());
    }
}
