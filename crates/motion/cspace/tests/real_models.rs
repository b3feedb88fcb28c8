//! The obstacle models of the joint-space paper on real robots: time and blocked cells of each, over the same cells.
//!
//! `cargo test --release -p elbowroom-cspace --test main real_models:: -- --ignored --nocapture` (minutes; the data is not part of
//! the repository).
#![allow(clippy::print_stdout, reason = "a table is what it is for")]

use crate::common::occupancy;
use std::time::{Duration, Instant};

use crate::clock::best;
use crate::common::occupancy::compare;
use crate::common::real::{ROBOTS, obstacles, reach};
use crate::common::robots::{Case, axes, cuboid};
use elbowroom_cspace::{
    CoverMapBuilder, CoverMapSettings, CoverObstacle, Grid, Layer, ObstacleModel, OccupancyBitmap, RemainingJoints,
    SphereRefinement,
};
use elbowroom_formats::robot::{LoadOptions, load};
use elbowroom_testkit::folder;

const MODELS: [ObstacleModel; 6] = [
    ObstacleModel::Exact,
    ObstacleModel::Sphere,
    ObstacleModel::Spheres(2),
    ObstacleModel::Spheres(8),
    ObstacleModel::Box,
    ObstacleModel::Slices,
];

#[test]
#[ignore = "minutes; cargo test --release -p elbowroom-cspace --test main real_models:: -- --ignored --nocapture"]
fn slices_are_the_quickest_model() {
    let Some(data) = folder::data() else { return };
    for name in ROBOTS {
        let file = data.join("urdf").join(name).join(format!("{name}.urdf"));
        let robot = load(&file, &LoadOptions::default()).unwrap().robot;
        let far = reach(&robot);
        let mut cases = vec![("cube", cuboid([0.5 * far, 0.2 * far, 0.3 * far], [0.0, 0.0, 0.5], [0.2 * far; 3]))];
        let names = ["table", "column", "sphere", "over the base", "mesh"];
        cases.extend(names.into_iter().zip(obstacles(far)));
        for (what, obstacle) in cases {
            let mut case = Case::new(vec![obstacle]);
            case.robot = robot.clone();
            case.fixed = Some(vec![0.1; robot.chain.dof()]);
            case.step = 2.0;
            measure(name, what, &case);
        }
    }
}

fn measure(name: &str, what: &str, case: &Case) {
    let grid = Grid::new(axes(&case.robot, &case.joints, case.step).try_into().unwrap()).unwrap();
    let remaining = case.fixed.as_deref().map_or(RemainingJoints::Swept, RemainingJoints::Fixed);
    let builder =
        CoverMapBuilder::new(&case.robot, case.base, &grid, [0, 1, 2], remaining, CoverMapSettings::default()).unwrap();
    let (mut exact, mut quickest) = (0, Duration::MAX);
    for model in MODELS {
        let (shape, at) = &case.obstacles[0];
        let slices = model == ObstacleModel::Slices;
        let solids = if slices { Vec::new() } else { model.solids(shape, at, &builder.base_in_world()) };
        let prepared: Vec<CoverObstacle> = solids.iter().map(|(s, _)| builder.obstacle(s).unwrap()).collect();
        let mut layers: Vec<Layer> = Vec::new();
        let time = best(15, || {
            layers = if slices {
                vec![builder.slice_layer(shape, at).unwrap()]
            } else {
                prepared.iter().zip(&solids).map(|(o, (_, at))| builder.layer(o, at).unwrap()).collect()
            };
        });
        quickest = if slices { quickest } else { quickest.min(time) };
        assert!(!slices || time < quickest, "slices took {time:?}, another model {quickest:?}");
        let mut map = OccupancyBitmap::new(grid.shape());
        for layer in &layers {
            map.add(layer);
        }
        if model == ObstacleModel::Exact {
            exact = map.blocked();
        }
        compare(case, &grid, &map, 20_000);
        let more = 100.0 * (map.blocked() as f64 / exact.max(1) as f64 - 1.0);
        let ms = time.as_secs_f64() * 1e3;
        println!("{name:<14} {what:<14} {:<10} {ms:>8.3} ms {:>9} {more:>+7.1} %", model.to_string(), map.blocked());
    }
}

#[test]
#[ignore = "a minute; cargo test --release -p elbowroom-cspace --test main real_models:: -- --ignored --nocapture"]
fn spheres_until_a_deadline_and_expansion_from_seeds() {
    let Some(data) = folder::data() else { return };
    for name in ROBOTS {
        let file = data.join("urdf").join(name).join(format!("{name}.urdf"));
        let robot = load(&file, &LoadOptions::default()).unwrap().robot;
        let far = reach(&robot);
        let mut case = Case::new(vec![cuboid([0.5 * far, 0.2 * far, 0.3 * far], [0.0, 0.0, 0.5], [0.2 * far; 3])]);
        case.fixed = Some(vec![0.1; robot.chain.dof()]);
        case.step = 2.0;
        case.robot = robot;
        measure_deadlines_and_seeds(name, &case);
    }
}

fn measure_deadlines_and_seeds(name: &str, case: &Case) {
    let grid = Grid::new(axes(&case.robot, &case.joints, case.step).try_into().unwrap()).unwrap();
    let remaining = case.fixed.as_deref().map_or(RemainingJoints::Swept, RemainingJoints::Fixed);
    let builder =
        CoverMapBuilder::new(&case.robot, case.base, &grid, [0, 1, 2], remaining, CoverMapSettings::default()).unwrap();
    let (shape, at) = &case.obstacles[0];
    let obstacle = builder.obstacle(shape).unwrap();
    let exact = occupancy::occupancy(&grid, &[builder.layer(&obstacle, at).unwrap()]);
    for ms in [0, 10, 30, 100, 300] {
        let begin = Instant::now();
        let deadline = begin + Duration::from_millis(ms);
        let mut spheres = SphereRefinement::new(&builder, shape, *at, 4096).unwrap();
        while spheres.refine(Some(deadline)).unwrap() {}
        let (took, count) = (begin.elapsed(), spheres.spheres());
        let map = occupancy::occupancy(&grid, &[spheres.into_layer()]);
        compare(case, &grid, &map, 20_000);
        let more = 100.0 * (map.blocked() as f64 / exact.blocked() as f64 - 1.0);
        println!(
            "{name:<14} deadline {ms:>4} ms, took {took:>7.1?}: {count:>4} spheres {:>9} {more:>+7.1} %",
            map.blocked()
        );
    }
    let begin = Instant::now();
    let found = builder.expand_from_seeds(&obstacle, at).unwrap();
    let took = begin.elapsed();
    let missed = exact.iter().filter(|cell| !found.occupancy.is_blocked(*cell)).count();
    println!(
        "{name:<14} seeds {:>4}, tested {:>8}, filled {:>8}, {took:>7.1?}: blocked {:>8}, missed {missed} of {}",
        found.seeds,
        found.tested,
        found.filled,
        found.occupancy.blocked(),
        exact.blocked()
    );
}
