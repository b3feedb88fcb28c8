//! The slices of any robot, its refined spheres, and its expansion from seeds, compared with the map of the robot's own
//! solids.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::common::covers::KeptCovers;
use crate::common::long_run;
use crate::common::occupancy::{compare, occupancy};
use crate::common::robots::{Case, Random, axes, box_mesh, cuboid, six_joints};
use elbowroom_cspace::{
    CoverMapBuilder, CoverMapSettings, Grid, Layer, OccupancyBitmap, RemainingJoints, RobotMapError, SphereRefinement,
};
use elbowroom_kinematics::JointKind;
use elbowroom_proximity::{Capsule, Cylinder, HalfSpace, Shape, Sphere, TriMesh};
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Pose, Vec3};

fn grid(case: &Case) -> Grid {
    Grid::new(axes(&case.robot, &case.joints, case.step).try_into().unwrap()).unwrap()
}

fn builder(case: &Case) -> CoverMapBuilder {
    let joints = case.joints.clone().try_into().unwrap();
    let remaining = case.fixed.as_deref().map_or(RemainingJoints::Swept, RemainingJoints::Fixed);
    let settings = CoverMapSettings::default();
    CoverMapBuilder::with_covers(&case.robot, case.base, &grid(case), joints, remaining, settings, &KeptCovers).unwrap()
}

fn slices(case: &Case) -> OccupancyBitmap {
    let builder = builder(case);
    let layers: Vec<Layer> = case.obstacles.iter().map(|(s, at)| builder.slice_layer(s, at).unwrap()).collect();
    occupancy(&grid(case), &layers)
}

/// Number of cells that the map of the robot's own solids blocks, and of those cells that `map` leaves free.
fn exact_and_missed(case: &Case, map: &OccupancyBitmap) -> (usize, usize) {
    let tree = case.builder().build(&case.obstacles).unwrap();
    let [a, b, c] = map.shape();
    let (mut exact, mut missed) = (0, 0);
    for cell in (0..a).flat_map(|i| (0..b).flat_map(move |j| (0..c).map(move |k| [i as u16, j as u16, k as u16]))) {
        if tree.is_blocked_cell(&cell) {
            exact += 1;
            missed += usize::from(!map.is_blocked(cell));
        }
    }
    (exact, missed)
}

/// Checks that the slices block all exact cells and all collisions; returns the fraction of cells that they block
/// beyond the exact ones.
fn check(case: &Case, samples: usize) -> f64 {
    let map = slices(case);
    let (exact, missed) = exact_and_missed(case, &map);
    assert_eq!(missed, 0, "of {exact} exact cells");
    compare(case, &grid(case), &map, samples);
    map.blocked() as f64 / exact.max(1) as f64 - 1.0
}

fn obstacles() -> Vec<(Shape, Pose)> {
    vec![
        cuboid([0.6, 0.2, 0.5], [0.0, 0.0, 0.8], [0.2, 0.1, 0.3]),
        (Shape::Sphere(Sphere { radius: 0.12 }), Pose::from_translation(Vec3::new(-0.4, 0.5, 0.9))),
        (
            Shape::Capsule(Capsule { half_length: 0.2, radius: 0.05 }),
            Pose::from_xyz_rpy([0.3, -0.6, 0.6], [0.4, 0.3, 0.0]),
        ),
        (
            Shape::Cylinder(Cylinder { half_length: 0.3, radius: 0.1 }),
            Pose::from_xyz_rpy([-0.5, -0.3, 0.4], [0.2, 0.0, 0.0]),
        ),
        (Shape::Mesh(Arc::new(box_mesh(0.25))), Pose::from_xyz_rpy([0.0, 0.0, 1.25], [0.2, 0.5, 0.1])),
    ]
}

#[test]
fn slices_hold_the_exact_map() {
    for obstacle in obstacles() {
        let mut case = Case::new(vec![obstacle]);
        case.step = 5.0;
        let more = check(&case, 5000);
        assert!(more < 2.5, "{:?}: {more}", case.obstacles);
    }
}

#[test]
fn slices_of_a_box_about_the_axis_are_close() {
    let mut case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.0, 0.0, 0.32], [0.2, 0.1, 0.3])]);
    case.step = 3.0;
    let more = check(&case, 20_000);
    assert!(more < 0.5, "{more}");
}

#[test]
fn slices_of_arms_that_are_not_in_a_plane() {
    let mut case = Case::new(obstacles());
    case.robot = six_joints();
    case.base = Pose::from_xyz_rpy([0.1, -0.05, 0.02], [0.1, 0.2, 0.3]);
    case.step = 8.0;
    for fixed in [Some(vec![0.0, 0.0, 0.0, 0.4, -0.9, 1.0]), None] {
        case.fixed = fixed;
        check(&case, 5000);
    }
    // A link beside the plane of the arm, and one that crosses the axis.
    case.fixed = Some(vec![0.0; 6]);
    for (link, at) in [(2, [0.0, 0.3, 0.1]), (3, [-0.5, -0.2, 0.2])] {
        let collider = Collider {
            name: String::new(),
            shape: Shape::Sphere(Sphere { radius: 0.08 }),
            in_link: Pose::from_xyz_rpy(at, [0.0; 3]),
        };
        case.robot.colliders[link].push(collider);
    }
    check(&case, 5000);
}

#[test]
fn slices_of_random_robots() {
    let mut random = Random(41);
    for _ in 0..long_run(12, 4) {
        let at = [0; 3].map(|_| random.between(-0.8, 0.8));
        let rpy = [0; 3].map(|_| random.between(-1.5, 1.5));
        let mut case = Case::new(vec![cuboid(at, rpy, [0.3, 0.1, 0.2])]);
        case.robot = turned(&case.robot, &mut random);
        case.step = random.between(6.0, 12.0);
        check(&case, 4000);
    }
}

/// The robot with joints that turn about other axes, the first one far in both directions.
fn turned(robot: &Robot, random: &mut Random) -> Robot {
    let mut joints = robot.chain.joints().to_vec();
    for joint in &mut joints {
        let axis = Vec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), 1.0);
        joint.axis = axis.try_normalize().unwrap();
        joint.origin.translation.y += random.between(-0.15, 0.15);
    }
    joints[0].limits.lower = random.between(-4.0, -1.0);
    let chain = elbowroom_kinematics::Chain::new("turned", robot.chain.links().to_vec(), joints).unwrap();
    let mut turned = Robot::new(chain);
    turned.colliders.clone_from(&robot.colliders);
    turned
}

#[test]
fn slices_of_axes_of_more_than_a_turn() {
    let mut case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    let mut joints = case.robot.chain.joints().to_vec();
    for joint in &mut joints {
        (joint.limits.lower, joint.limits.upper) = (-6.0, 6.6);
    }
    // The opposite direction.
    joints[0].axis = -Vec3::Z;
    let chain = elbowroom_kinematics::Chain::new("turns", case.robot.chain.links().to_vec(), joints).unwrap();
    let colliders = case.robot.colliders.clone();
    case.robot = Robot::new(chain);
    case.robot.colliders = colliders;
    case.step = 10.0;
    check(&case, 5000);
    // The width of cells does not divide a turn.
    case.step = 11.0;
    check(&case, 5000);
}

/// The slice of a solid around the arm has no hole; the slice of a solid beside the axis may have holes.
#[test]
fn a_solid_around_the_arm_blocks_everything() {
    let mut case = Case::new(vec![(Shape::Mesh(Arc::new(box_mesh(6.0))), Pose::IDENTITY)]);
    case.step = 12.0;
    let map = slices(&case);
    assert_eq!(map.blocked(), grid(&case).cells());
    case.obstacles = vec![cuboid([0.45, 0.0, 0.3], [0.0; 3], [0.1, 0.1, 0.1])];
    check(&case, 2000);
    assert!(slices(&case).blocked() < grid(&case).cells());
}

#[test]
fn the_oracle_detects_a_smaller_obstacle() {
    let mut case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.1, 0.05, 0.2])]);
    case.step = 5.0;
    let small = slices(&case);
    case.obstacles = vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.3, 0.2, 0.4])];
    assert!(exact_and_missed(&case, &small).1 > 0);
}

#[test]
fn what_has_no_bounds_blocks_what_it_does_itself() {
    let floor = (Shape::HalfSpace(HalfSpace), Pose::from_translation(Vec3::Z * 0.1));
    let mut case = Case::new(vec![floor]);
    case.step = 6.0;
    let itself = |case: &Case| {
        let (shape, at) = &case.obstacles[0];
        let builder = builder(case);
        occupancy(&grid(case), &[builder.layer(&builder.obstacle(shape).unwrap(), at).unwrap()])
    };
    assert_eq!(slices(&case), itself(&case));
    // If the first joint is prismatic, it turns nothing.
    case.obstacles = vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])];
    let mut joints = case.robot.chain.joints().to_vec();
    joints[0].kind = JointKind::Prismatic;
    (joints[0].limits.lower, joints[0].limits.upper) = (-0.5, 0.5);
    let chain = elbowroom_kinematics::Chain::new("slide", case.robot.chain.links().to_vec(), joints).unwrap();
    let colliders = case.robot.colliders.clone();
    case.robot = Robot::new(chain);
    case.robot.colliders = colliders;
    assert_eq!(slices(&case), itself(&case));
}

#[test]
fn slices_refuse_what_is_not_finite() {
    let case = Case::new(Vec::new());
    let builder = builder(&case);
    let nowhere = Pose::from_translation(Vec3::new(f64::NAN, 0.0, 0.0));
    let far = Pose::from_translation(Vec3::X * 1e9);
    let ball = Shape::Sphere(Sphere { radius: 0.1 });
    let refused = [
        builder.slice_layer(&ball, &nowhere),
        builder.slice_layer(&ball, &far),
        builder.slice_layer(&Shape::Sphere(Sphere { radius: f64::NAN }), &Pose::IDENTITY),
    ];
    assert!(refused.into_iter().all(|r| matches!(r, Err(RobotMapError::InvalidPlacement(_)))));
}

#[test]
fn spheres_are_refined_until_the_deadline_and_never_miss_a_cell() {
    let mut case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.5, 0.1, 0.1])]);
    case.step = 6.0;
    let (builder, grid) = (builder(&case), grid(&case));
    let (shape, at) = &case.obstacles[0];
    let over = Instant::now();
    let mut late = SphereRefinement::new(&builder, shape, *at, 64).unwrap();
    assert!(!late.refine(Some(over)).unwrap());
    assert_eq!(late.spheres(), 1);
    let mut before = occupancy(&grid, &[late.into_layer()]);
    for most in [1, 2, 8, 20, 64] {
        let mut spheres = SphereRefinement::new(&builder, shape, *at, most).unwrap();
        while spheres.refine(Some(Instant::now() + Duration::from_mins(1))).unwrap() {}
        assert_eq!(spheres.spheres(), 1 << most.ilog2());
        let map = occupancy(&grid, &[spheres.into_layer()]);
        assert_eq!(exact_and_missed(&case, &map).1, 0);
        assert!(map.iter().all(|cell| before.is_blocked(cell)), "{most} spheres block a cell that fewer do not");
        assert!(most == 1 || map.blocked() < before.blocked());
        before = map;
    }
}

#[test]
fn an_expansion_finds_what_hangs_together_with_its_seeds() {
    let mut case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    case.step = 5.0;
    let builder = builder(&case);
    let (shape, at) = &case.obstacles[0];
    let found = builder.expand_from_seeds(&builder.obstacle(shape).unwrap(), at).unwrap();
    let (exact, missed) = exact_and_missed(&case, &found.occupancy);
    assert!(found.seeds > 0 && found.filled > 0 && found.tested < grid(&case).cells(), "{found:?}");
    assert_eq!(missed, 0, "of {exact}");
    // The expansion finds every blocked neighbour: a free neighbour of a blocked cell is proven free.
    compare(&case, &grid(&case), &found.occupancy, 5000);
}

/// Shows why no robot may rely on an expansion: seeds are where links are nearest to the centre of an obstacle, and one
/// of two parts contains no seed.
#[test]
fn an_expansion_misses_an_obstacle_of_two_parts() {
    let mesh = box_mesh(0.1);
    let moved = |y: f64| mesh.vertices().iter().map(move |p| *p + Vec3::Y * y);
    let faces = mesh.triangles();
    let second = faces.iter().map(|f| f.map(|v| v + mesh.vertices().len() as u32));
    let both = TriMesh::new(moved(0.5).chain(moved(-0.5)).collect(), faces.iter().copied().chain(second).collect());
    let mut case =
        Case::new(vec![(Shape::Mesh(Arc::new(both.unwrap())), Pose::from_xyz_rpy([0.7, 0.0, 0.7], [0.0; 3]))]);
    case.step = 6.0;
    let builder = builder(&case);
    let (shape, at) = &case.obstacles[0];
    let found = builder.expand_from_seeds(&builder.obstacle(shape).unwrap(), at).unwrap();
    let (exact, missed) = exact_and_missed(&case, &found.occupancy);
    assert!(missed > 0, "{exact} exact cells, all found: {found:?}");
}
