//! Boxes and convex polyhedra: every contact is found, few cells are blocked needlessly.

use std::sync::Arc;

use crate::common::{RandomGeometry, SampleCounts, Xorshift, fill, grid, grid_of, missed_contacts, needless_share};
use elbowroom_cspace::{ConvexObstacle, Grid, PlanarArm};
use elbowroom_proximity::ConvexHull;
use elbowroom_spatial::{Pose, Vec3};

const ARM: PlanarArm = PlanarArm::KR125_SIZED;

fn cuboid(at: [f64; 3], rpy: [f64; 3], half: [f64; 3]) -> ConvexObstacle {
    ConvexObstacle::cuboid(Pose::from_xyz_rpy(at, rpy), Vec3::from(half)).unwrap()
}

/// The baseline's box.
fn baseline(shrink: f64) -> ConvexObstacle {
    cuboid([1.3, 0.4, 0.9], [0.0, 0.0, 30f64.to_radians()], [0.25 - shrink, 0.2 - shrink, 0.3 - shrink])
}

fn hard_cases() -> Vec<ConvexObstacle> {
    vec![
        baseline(0.0),
        cuboid([1.3, 0.4, 0.9], [0.4, 0.7, 0.5], [0.25, 0.2, 0.3]), // tilted
        cuboid([0.0, 0.0, 2.0], [0.0, 0.0, 0.3], [0.4, 0.3, 0.2]),  // over the base axis
        cuboid([0.1, -0.2, 1.9], [0.5, -0.4, 0.3], [0.5, 0.3, 0.2]), // over it and tilted
        cuboid([0.0, 0.45, 1.5], [0.0, 0.0, 0.0], [0.3, 0.4, 0.2]), // its edge at the axis
        cuboid([-1.2, 0.3, 1.4], [0.2, 0.1, 0.9], [0.2, 0.3, 0.2]), // behind the base
        cuboid([0.5, 0.0, 0.9], [0.1, 0.2, 0.0], [0.3, 0.3, 0.3]),  // contains the shoulder
        cuboid([2.5, 0.0, 0.7], [0.0, 0.3, 0.1], [0.1, 0.1, 0.1]),  // at the end of the reach
        cuboid([1.5, 0.0, 0.9], [0.0, 0.0, 0.2], [0.01, 1.5, 0.01]), // a bar across: several arcs
        cuboid([1.4, 0.0, 0.9], [0.0, 0.0, 0.0], [1.2, 0.02, 0.02]), // a bar along
        cuboid([1.1, 0.1, 1.7], [0.0, 1.1, 0.2], [1.2, 0.02, 0.02]),
        cuboid([0.0, 0.0, -0.6], [0.0, 0.0, 0.0], [3.0, 3.0, 0.1]), // a floor
        cuboid([1.2, 0.2, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),  // a point
        cuboid([1.2, 0.2, 1.0], [0.3, 0.5, 0.7], [0.3, 0.2, 0.0]),  // a plate
        cuboid([40.0, 0.0, 0.0], [0.0, 0.0, 0.0], [38.5, 30.0, 30.0]),
    ]
}

fn random_hull(random: &mut Xorshift, size: f64) -> Arc<ConvexHull> {
    loop {
        let points: Vec<Vec3> = (0..4 + random.index(12)).map(|_| random.vector(size)).collect();
        if let Ok(hull) = ConvexHull::from_points(&points) {
            return Arc::new(hull);
        }
    }
}

fn random_pose(random: &mut Xorshift) -> Pose {
    let at = Vec3::new(random.between(-2.3, 2.3), random.between(-2.3, 2.3), random.between(-1.0, 2.8));
    let at = if random.index(5) == 0 { Vec3::new(at.x * 0.1, at.y * 0.1, at.z) } else { at };
    let tilt = if random.index(3) == 0 { 0.0 } else { 3.0 };
    let rpy = random.vector(tilt);
    Pose::from_xyz_rpy([at.x, at.y, at.z], [rpy.x, rpy.y, random.between(-3.0, 3.0)])
}

fn random_obstacle(random: &mut Xorshift) -> ConvexObstacle {
    let pose = random_pose(random);
    let size = [0.01, 0.1, 0.3, 1.0, 4.0][random.index(5)];
    if random.index(2) == 0 {
        let half = (random.vector(size)).abs();
        ConvexObstacle::cuboid(pose, half).unwrap()
    } else {
        let hull = random_hull(random, size);
        ConvexObstacle::hull(pose, hull).unwrap()
    }
}

fn check(arm: &PlanarArm, grid: &Grid, obstacle: &ConvexObstacle, samples: SampleCounts, random: &mut Xorshift) {
    let occupancy = fill(arm, grid, obstacle);
    let missed = missed_contacts(arm, grid, &occupancy, obstacle, samples, random);
    assert_eq!(missed, 0, "step {}: {obstacle:?} blocks {}", grid.axes()[0].step().to_degrees(), occupancy.blocked());
}

#[test]
fn no_contact_with_a_hard_box_lies_in_a_free_cell() {
    let mut random = Xorshift(0x9e37_79b9_7f4a_7c15);
    for step in [2.0, 5.0] {
        for obstacle in &hard_cases() {
            check(&ARM, &grid(step), obstacle, SampleCounts { uniform: 5_000, beside: 5_000 }, &mut random);
        }
    }
}

#[test]
fn no_contact_with_a_random_solid_lies_in_a_free_cell() {
    let mut random = Xorshift(77);
    for round in 0..48 {
        let step = [3.0, 4.0, 7.0, 12.0][round % 4];
        let ranges = [[-185.0, 185.0], [-140.0, 155.0], [-240.0, 200.0]];
        let grid = if round % 2 == 0 { grid(step) } else { grid_of(step, ranges) };
        let arm = match round % 3 {
            0 => PlanarArm { offset_m: -0.1, wrist_radius_m: 0.05, ..ARM },
            1 => PlanarArm { upper_radius_m: 0.0, fore_radius_m: 0.001, wrist_radius_m: 0.0, ..ARM },
            _ => ARM,
        };
        let obstacle = random_obstacle(&mut random);
        check(&arm, &grid, &obstacle, SampleCounts { uniform: 1_500, beside: 2_500 }, &mut random);
    }
}

#[test]
fn a_hundred_thousand_configurations_of_the_baseline() {
    let mut random = Xorshift(13);
    check(&ARM, &grid(2.0), &baseline(0.0), SampleCounts { uniform: 100_000, beside: 100_000 }, &mut random);
}

#[test]
fn the_oracle_detects_solids_smaller_by_2_mm() {
    let mut random = Xorshift(7);
    let grid = grid(2.0);
    let places =
        [([1.3, 0.4, 0.9], [0.0, 0.0, 0.52]), ([1.3, 0.4, 0.9], [0.4, 0.7, 0.5]), ([-1.2, 0.3, 1.4], [0.2, 0.1, 0.9])];
    for (at, rpy) in places {
        let occupancy = fill(&ARM, &grid, &cuboid(at, rpy, [0.248, 0.198, 0.298]));
        let whole = cuboid(at, rpy, [0.25, 0.2, 0.3]);
        assert!(
            missed_contacts(&ARM, &grid, &occupancy, &whole, SampleCounts { uniform: 0, beside: 20_000 }, &mut random)
                > 0,
            "{at:?}"
        );
    }
}

#[test]
fn few_cells_are_blocked_needlessly() {
    let mut random = Xorshift(11);
    let grid = grid(2.0);
    for (i, obstacle) in hard_cases().iter().enumerate() {
        let occupancy = fill(&ARM, &grid, obstacle);
        let samples = if i == 0 { 4000 } else { 500 };
        let share = needless_share(&ARM, &grid, &occupancy, obstacle, samples, &mut random);
        println!("case {i}: {} blocked, {:.2} % needlessly", occupancy.blocked(), share * 100.0);
        // A floor that only the wrist reaches blocks a thin shell, so nearly every cell is at the boundary.
        let most = [0.006, 0.03, 0.06][usize::from(i > 0) + usize::from(i == 11)];
        assert!(share <= most, "case {i}: {share}");
    }
}
