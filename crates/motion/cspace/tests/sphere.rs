//! Spheres: every contact is found, few cells are blocked needlessly.

use crate::common::{SampleCounts, Xorshift, fill, grid, missed_contacts, needless_share};
use elbowroom_cspace::{ConvexObstacle, PlanarArm};
use elbowroom_spatial::Vec3;

const ARM: PlanarArm = PlanarArm::KR125_SIZED;

fn sphere(x: f64, y: f64, z: f64, radius: f64) -> ConvexObstacle {
    ConvexObstacle::sphere(Vec3::new(x, y, z), radius).unwrap()
}

#[test]
fn no_contact_lies_in_a_free_cell() {
    let mut random = Xorshift(0x9e37_79b9_7f4a_7c15);
    let cases = [
        sphere(1.3, 0.4, 0.9, 0.25),
        sphere(1.3, 0.4, 0.9, 0.0),
        sphere(0.0, 0.0, 2.0, 0.3),   // over the base axis
        sphere(0.05, -0.1, 1.9, 0.2), // nearly over it
        sphere(0.0, 0.6, 2.0, 0.3),
        sphere(-1.2, 0.3, 1.4, 0.25), // reached by an arm bent backwards
        sphere(0.9, 0.0, 0.9, 0.9),   // contains the shoulder
        sphere(2.6, 0.0, 0.675, 0.1), // at the end of the reach
        sphere(0.4, 0.1, -0.8, 0.15),
        sphere(2.0, 40.0, 0.0, 39.0), // huge
    ];
    for step in [2.0, 5.0] {
        let grid = grid(step);
        for obstacle in &cases {
            let occupancy = fill(&ARM, &grid, obstacle);
            let missed = missed_contacts(
                &ARM,
                &grid,
                &occupancy,
                obstacle,
                SampleCounts { uniform: 20_000, beside: 20_000 },
                &mut random,
            );
            assert_eq!(missed, 0, "step {step}: {obstacle:?} blocks {}", occupancy.blocked());
        }
    }
}

#[test]
fn the_oracle_detects_a_sphere_smaller_by_2_mm() {
    let mut random = Xorshift(7);
    let grid = grid(2.0);
    let (whole, smaller) = (sphere(1.3, 0.4, 0.9, 0.25), sphere(1.3, 0.4, 0.9, 0.248));
    let occupancy = fill(&ARM, &grid, &smaller);
    assert!(
        missed_contacts(&ARM, &grid, &occupancy, &whole, SampleCounts { uniform: 0, beside: 20_000 }, &mut random) > 0
    );
}

#[test]
fn few_cells_are_blocked_needlessly() {
    let mut random = Xorshift(11);
    for (step, obstacle) in [(2.0, sphere(1.3, 0.4, 0.9, 0.25)), (5.0, sphere(-1.2, 0.3, 1.4, 0.25))] {
        let grid = grid(step);
        let occupancy = fill(&ARM, &grid, &obstacle);
        let share = needless_share(&ARM, &grid, &occupancy, &obstacle, 3000, &mut random);
        println!("step {step}: {} blocked, {:.2} % needlessly", occupancy.blocked(), share * 100.0);
        assert!(share < 0.01, "{share}");
    }
}
