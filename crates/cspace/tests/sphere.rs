//! Balls: no miss, little blocked needlessly.

mod common;

use common::{Random, fill, grid, misses, needless};
use elbowroom_cspace::{Obstacle, PlanarArm};
use elbowroom_spatial::Vec3;

const ARM: PlanarArm = PlanarArm::KR125_SIZED;

fn ball(x: f64, y: f64, z: f64, radius: f64) -> Obstacle {
    Obstacle::sphere(Vec3::new(x, y, z), radius).unwrap()
}

#[test]
fn no_configuration_that_touches_lies_in_a_free_cell() {
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let cases = [
        ball(1.3, 0.4, 0.9, 0.25),
        ball(1.3, 0.4, 0.9, 0.0),
        ball(0.0, 0.0, 2.0, 0.3),   // over the base axis
        ball(0.05, -0.1, 1.9, 0.2), // nearly over it
        ball(0.0, 0.6, 2.0, 0.3),
        ball(-1.2, 0.3, 1.4, 0.25), // reached by an arm bent backwards
        ball(0.9, 0.0, 0.9, 0.9),   // holds the shoulder
        ball(2.6, 0.0, 0.675, 0.1), // at the end of the reach
        ball(0.4, 0.1, -0.8, 0.15),
        ball(2.0, 40.0, 0.0, 39.0), // huge
    ];
    for step in [2.0, 5.0] {
        let grid = grid(step);
        for obstacle in &cases {
            let table = fill(&ARM, &grid, obstacle);
            let missed = misses(&ARM, &grid, &table, obstacle, (20_000, 20_000), &mut random);
            assert_eq!(missed, 0, "step {step}: {obstacle:?} blocks {}", table.blocked());
        }
    }
}

#[test]
fn a_ball_smaller_by_2_mm_would_be_noticed() {
    let mut random = Random(7);
    let grid = grid(2.0);
    let (whole, smaller) = (ball(1.3, 0.4, 0.9, 0.25), ball(1.3, 0.4, 0.9, 0.248));
    let table = fill(&ARM, &grid, &smaller);
    assert!(misses(&ARM, &grid, &table, &whole, (0, 20_000), &mut random) > 0);
}

#[test]
fn few_cells_are_blocked_needlessly() {
    let mut random = Random(11);
    for (step, obstacle) in [(2.0, ball(1.3, 0.4, 0.9, 0.25)), (5.0, ball(-1.2, 0.3, 1.4, 0.25))] {
        let grid = grid(step);
        let table = fill(&ARM, &grid, &obstacle);
        let share = needless(&ARM, &grid, &table, &obstacle, 3000, &mut random);
        println!("step {step}: {} blocked, {:.2} % needlessly", table.blocked(), share * 100.0);
        assert!(share < 0.01, "{share}");
    }
}
