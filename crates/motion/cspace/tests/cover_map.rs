//! Maps on covers compared with single configurations: every collision is blocked.

use std::sync::Arc;

use elbowroom_cspace::{
    CoverMapBuilder, CoverMapSettings, Grid, GridAxis, Layer, OccupancyBitmap, PlanarArm, RemainingJoints,
    RobotMapError,
};
use elbowroom_kinematics::{Chain, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::{Capsule, ConvexHull, Cuboid, Cylinder, HalfSpace, Shape, Sphere};
use elbowroom_robot::{Collider, Robot, example};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_validity::{CoverSource, SphereCover};

use crate::common::covers::KeptCovers;
use crate::common::long_run;
use crate::common::occupancy::{compare, needless_share, occupancy};
use crate::common::robots::{Case, Random, axes, box_mesh, cuboid, six_joints};

fn grid(case: &Case) -> Grid {
    Grid::new(axes(&case.robot, &case.joints, case.step).try_into().unwrap()).unwrap()
}

fn builder(case: &Case, grid: &Grid, settings: CoverMapSettings) -> CoverMapBuilder {
    let joints = case.joints.clone().try_into().unwrap();
    let remaining = case.fixed.as_deref().map_or(RemainingJoints::Swept, RemainingJoints::Fixed);
    CoverMapBuilder::with_covers(&case.robot, case.base, grid, joints, remaining, settings, &KeptCovers).unwrap()
}

fn map(case: &Case, settings: CoverMapSettings) -> OccupancyBitmap {
    let grid = grid(case);
    let builder = builder(case, &grid, settings);
    let layer = |(shape, at): &(Shape, Pose)| builder.layer(&builder.obstacle(shape).unwrap(), at).unwrap();
    let layers: Vec<Layer> = case.obstacles.iter().map(layer).collect();
    occupancy(&grid, &layers)
}

/// Builds a map and checks it; returns the number of blocked cells.
fn check(case: &Case, samples: usize) -> usize {
    let map = map(case, CoverMapSettings::default());
    let collisions = compare(case, &grid(case), &map, samples);
    assert!(collisions > 0 || map.blocked() == 0, "no sample is in collision: the test is void");
    map.blocked()
}

#[test]
fn collisions_are_blocked_and_hardly_more() {
    let mut case = Case::new(vec![
        cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3]),
        (Shape::Sphere(Sphere { radius: 0.12 }), Pose::from_translation(Vec3::new(-0.4, 0.5, 0.9))),
        (
            Shape::Capsule(Capsule { half_length: 0.2, radius: 0.05 }),
            Pose::from_xyz_rpy([0.3, -0.6, 0.6], [0.4, 0.3, 0.0]),
        ),
    ]);
    case.step = 3.0;
    check(&case, 20_000);
    let grid = grid(&case);
    let map = map(&case, CoverMapSettings::default());
    let needless = needless_share(&case, &grid, &map, 600);
    assert!(needless <= 0.08, "{needless}");
}

#[test]
fn a_clearance_blocks_what_a_larger_ball_would() {
    let ball = |radius| {
        let place = |x, y, z| (Shape::Sphere(Sphere { radius }), Pose::from_translation(Vec3::new(x, y, z)));
        let mut case = Case::new(vec![place(0.6, 0.2, 0.5), place(-0.4, 0.5, 0.9)]);
        case.step = 3.0;
        case
    };
    let (small, large) = (ball(0.12), ball(0.17));
    let with_clearance = map(&small, CoverMapSettings { clearance_m: 0.05, ..CoverMapSettings::default() });
    assert!(compare(&large, &grid(&large), &with_clearance, 20_000) > 0);
    let of_large = map(&large, CoverMapSettings::default());
    assert!(with_clearance.blocked() as f64 <= 1.02 * of_large.blocked() as f64);
}

#[test]
fn the_oracle_detects_a_smaller_obstacle() {
    let mut case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.16, 0.06, 0.26])]);
    let small = map(&case, CoverMapSettings::default());
    case.obstacles = vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])];
    let grid = grid(&case);
    let found = std::panic::catch_unwind(|| compare(&case, &grid, &small, 40_000));
    assert!(found.is_err(), "the samples do not detect 2 cm");
}

#[test]
fn every_kind_of_obstacle() {
    let hull = ConvexHull::from_points(&[Vec3::X, Vec3::Y, Vec3::Z, Vec3::ZERO].map(|p| p * 0.3)).unwrap();
    let shapes = [
        (Shape::Cylinder(Cylinder { half_length: 0.2, radius: 0.1 }), [0.5, 0.3, 0.5], [0.5, 0.2, 0.0]),
        (Shape::HalfSpace(HalfSpace), [0.0, 0.0, 0.1], [0.05, 0.0, 0.0]),
        (Shape::Mesh(Arc::new(box_mesh(0.25))), [0.0, 0.0, 1.25], [0.2, 0.5, 0.1]),
        (Shape::Hull(Arc::new(hull)), [0.4, -0.5, 0.4], [0.4, 0.1, 1.0]),
    ];
    for (shape, at, rpy) in shapes {
        let mut case = Case::new(vec![(shape, Pose::from_xyz_rpy(at, rpy))]);
        case.step = 6.0;
        check(&case, 4000);
    }
}

#[test]
fn an_obstacle_around_the_arm_blocks_everything() {
    let case = Case::new(vec![(Shape::Mesh(Arc::new(box_mesh(6.0))), Pose::IDENTITY)]);
    let covers = check(&case, 10);
    assert_eq!(covers, grid(&case).cells());
}

#[test]
fn obstacles_inside_a_closed_link_are_found() {
    let mut case =
        Case::new(vec![(Shape::Sphere(Sphere { radius: 0.01 }), Pose::from_xyz_rpy([0.5, 0.1, 0.6], [0.0; 3]))]);
    case.robot.colliders.iter_mut().for_each(Vec::clear);
    let shape = Shape::Mesh(Arc::new(box_mesh(0.25)));
    case.robot.colliders[3].push(Collider {
        name: String::new(),
        shape,
        in_link: Pose::from_translation(Vec3::Z * 0.2),
    });
    case.step = 6.0;
    check(&case, 20_000);
}

/// A cell of a link of two axes represents all values of the third axis: it is tested even if other links block some of
/// these values.
#[test]
fn a_row_is_tested_where_another_link_blocks_its_first_cell() {
    let mut case = Case::new(vec![cuboid([0.6, 0.2, 0.6], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    case.robot = six_joints();
    case.base = Pose::from_xyz_rpy([0.1, -0.05, 0.02], [0.1, 0.2, 0.3]);
    case.step = 6.0;
    case.fixed = Some(vec![0.0, 0.0, 0.0, 0.4, -0.9, 1.0]);
    let q = [0.140_757_805_214_702_88, 1.260_133_492_573_92, 1.963_971_195_537_688_6];
    let cell = grid(&case).cell(q).unwrap();
    assert!(map(&case, CoverMapSettings::default()).is_blocked(cell));
}

/// A torso with an arm on either side, each moved by its own joint.
fn two_armed() -> Robot {
    let joint = |name: &str, parent: usize, child: usize, at: Vec3, axis: Vec3| Joint {
        name: name.into(),
        kind: JointKind::Revolute,
        parent: LinkId(parent),
        child: LinkId(child),
        origin: Pose::from_translation(at),
        axis,
        limits: Limits::symmetric(1.5),
        mimic: None,
    };
    let joints = vec![
        joint("torso", 0, 1, Vec3::Z * 0.3, Vec3::Z),
        joint("left", 1, 2, Vec3::new(0.0, 0.3, 0.4), Vec3::Y),
        joint("right", 1, 3, Vec3::new(0.0, -0.3, 0.4), Vec3::Y),
    ];
    let links = ["base", "torso", "left", "right"].map(String::from).to_vec();
    let mut robot = Robot::new(Chain::new("two-armed", links, joints).unwrap());
    for colliders in &mut robot.colliders[2..] {
        let shape = Shape::Capsule(Capsule { half_length: 0.25, radius: 0.05 });
        colliders.push(Collider { name: String::new(), shape, in_link: Pose::from_translation(Vec3::X * 0.3) });
    }
    robot
}

#[test]
fn an_arm_is_tested_where_the_other_blocks_the_first_cell_of_the_row() {
    // The wall is in reach of both arms; the left arm reaches it also at its lower limit.
    let mut case = Case::new(vec![cuboid([0.35, 0.0, 0.7], [0.0; 3], [0.1, 1.0, 0.7])]);
    case.robot = two_armed();
    case.step = 6.0;
    for joints in [vec![0, 1, 2], vec![0, 2, 1], vec![2, 0, 1]] {
        case.joints = joints;
        check(&case, 20_000);
    }
}

#[test]
fn joints_that_are_no_axes_are_enclosed_or_held() {
    let mut case = Case::new(vec![cuboid([0.6, 0.2, 0.6], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    case.robot = six_joints();
    case.base = Pose::from_xyz_rpy([0.1, -0.05, 0.02], [0.1, 0.2, 0.3]);
    case.step = 6.0;
    let any = check(&case, 10_000);
    case.fixed = Some(vec![0.0, 0.0, 0.0, 0.4, -0.9, 1.0]);
    let held = check(&case, 10_000);
    assert!(held < any);
    for joints in [vec![2, 0, 1], vec![1, 3, 2], vec![3, 4, 5]] {
        case.joints = joints;
        case.fixed = Some(vec![0.3, 0.9, 0.4, 0.4, -0.9, 1.0]);
        check(&case, 3000);
    }
}

/// A robot of three joints of any kind and axis, with solids of any kind.
fn random_robot(random: &mut Random) -> Robot {
    let mut axis = || Vec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), random.between(-1.0, 1.0));
    let directions = [0; 9].map(|_| axis());
    let joint = |i: usize, random: &mut Random| {
        let is_slide = random.unit() < 0.3;
        let range = if is_slide { 0.3 } else { random.between(0.5, 4.0) };
        Joint {
            name: format!("joint_{i}"),
            kind: if is_slide { JointKind::Prismatic } else { JointKind::Revolute },
            parent: LinkId(i),
            child: LinkId(i + 1),
            origin: Pose::from_xyz_rpy((directions[i] * 0.35).into(), directions[i + 3].into()),
            axis: directions[i + 6].try_normalize().unwrap_or(Vec3::Z),
            limits: Limits { lower: -range * random.unit(), upper: range, ..Limits::symmetric(1.0) },
            mimic: None,
        }
    };
    let joints = (0..3).map(|i| joint(i, random)).collect();
    let mut robot = Robot::new(Chain::new("random", (0..4).map(|i| format!("link_{i}")).collect(), joints).unwrap());
    for link in 1..4 {
        let size = random.between(0.04, 0.15);
        let shape = match (random.unit() * 4.0) as u32 {
            0 => Shape::Sphere(Sphere { radius: size }),
            1 => Shape::Cuboid(Cuboid { half_extents: Vec3::new(size, 0.5 * size, 0.1) }),
            2 => Shape::Capsule(Capsule { half_length: 0.15, radius: 0.5 * size }),
            _ => Shape::Cylinder(Cylinder { half_length: 0.1, radius: 0.6 * size }),
        };
        let in_link = Pose::from_xyz_rpy([0.0, 0.05, 0.1], [random.unit(), random.unit(), 0.0]);
        robot.colliders[link].push(Collider { name: String::new(), shape, in_link });
    }
    robot
}

#[test]
fn no_collision_of_random_robots_lies_in_a_free_cell() {
    let mut random = Random(24);
    let mut touched = 0;
    let rounds = long_run(18, 3);
    for round in 0..rounds {
        let mut case = Case::new(Vec::new());
        case.robot = random_robot(&mut random);
        case.step = random.between(4.0, 12.0);
        let at = [0; 3].map(|_| random.between(-0.7, 0.7));
        let rpy = [0; 3].map(|_| random.between(-1.5, 1.5));
        case.obstacles = match round % 3 {
            0 => vec![cuboid(at, rpy, [0.3, 0.1, 0.2])],
            1 => vec![(Shape::Sphere(Sphere { radius: 0.15 }), Pose::from_xyz_rpy(at, rpy))],
            _ => vec![(Shape::Cylinder(Cylinder { half_length: 0.3, radius: 0.05 }), Pose::from_xyz_rpy(at, rpy))],
        };
        let grid = grid(&case);
        let found = map(&case, CoverMapSettings::default());
        touched += usize::from(compare(&case, &grid, &found, 4000) > 0);
        let on_cores = |cores: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(cores).build().unwrap();
            pool.install(|| map(&case, CoverMapSettings::default()))
        };
        assert!([1, 3].into_iter().all(|cores| on_cores(cores).iter().eq(found.iter())), "another map on other cores");
    }
    assert!(touched * 3 >= rounds, "{touched} of {rounds}");
}

/// Maps in strips of eight values, the last of which is not full.
#[test]
fn a_fine_map_is_the_same_on_any_number_of_cores() {
    let mut case = Case::new(vec![cuboid([0.5, 0.2, 0.4], [0.3, 0.2, 0.8], [0.3, 0.2, 0.4])]);
    case.step = 1.03;
    let grid = grid(&case);
    assert!(grid.shape()[1] > 16 && !grid.shape()[1].is_multiple_of(8), "{:?}", grid.shape());
    let found = map(&case, CoverMapSettings::default());
    assert!(compare(&case, &grid, &found, 20_000) > 0);
    for cores in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(cores).build().unwrap();
        let other = pool.install(|| map(&case, CoverMapSettings::default()));
        assert!(other.iter().eq(found.iter()), "another map on {cores} cores");
    }
}

#[test]
fn joints_that_follow_others_move_with_them() {
    let mut random = Random(23);
    let mut touched = 0;
    let rounds = long_run(24, 3);
    for round in 0..rounds {
        let mut case = Case::new(Vec::new());
        case.robot = with_followers(&mut random);
        case.step = random.between(4.0, 9.0);
        let at = [0; 3].map(|_| random.between(-0.7, 0.7));
        let rpy = [0; 3].map(|_| random.between(-1.5, 1.5));
        case.obstacles = match round % 4 {
            0 => vec![cuboid(at, rpy, [0.4, 0.2, 0.2])],
            1 => vec![(Shape::Sphere(Sphere { radius: 0.2 }), Pose::from_xyz_rpy(at, rpy))],
            2 => vec![(Shape::Mesh(Arc::new(box_mesh(0.3))), Pose::from_xyz_rpy(at, rpy))],
            _ => vec![(Shape::Cylinder(Cylinder { half_length: 0.3, radius: 0.1 }), Pose::from_xyz_rpy(at, rpy))],
        };
        let grid = grid(&case);
        let found = map(&case, CoverMapSettings::default());
        touched += usize::from(compare(&case, &grid, &found, 4000) > 0);
    }
    assert!(touched * 3 >= rounds, "{touched} of {rounds}");
}

/// A random robot of three joints, and two more that follow the second and the third: revolute or prismatic, faster,
/// slower, or in the opposite direction.
fn with_followers(random: &mut Random) -> Robot {
    let robot = random_robot(random);
    let mut joints = robot.chain.joints().to_vec();
    let mut links = robot.chain.links().to_vec();
    for (i, leader) in [1, 2].into_iter().enumerate() {
        let is_slide = random.unit() < 0.4;
        let turn = |random: &mut Random| random.between(-1.0, 1.0);
        joints.push(Joint {
            name: format!("follower_{i}"),
            kind: if is_slide { JointKind::Prismatic } else { JointKind::Revolute },
            parent: LinkId(3 + i),
            child: LinkId(4 + i),
            origin: Pose::from_xyz_rpy([0.1, turn(random) * 0.2, 0.15], [turn(random), turn(random), 0.0]),
            axis: Vec3::new(turn(random), turn(random), 1.0).try_normalize().unwrap_or(Vec3::Z),
            limits: Limits::symmetric(20.0),
            mimic: Some(Mimic {
                joint: JointId(leader),
                multiplier: random.between(-1.5, 1.5) * if is_slide { 0.2 } else { 1.0 },
                offset: turn(random) * 0.1,
            }),
        });
        links.push(format!("following_link_{i}"));
    }
    let mut longer = Robot::new(Chain::new("followers", links, joints).unwrap());
    longer.colliders[..4].clone_from_slice(&robot.colliders);
    for link in [4, 5] {
        let shape = Shape::Capsule(Capsule { half_length: 0.12, radius: random.between(0.03, 0.08) });
        longer.colliders[link].push(Collider {
            name: String::new(),
            shape,
            in_link: Pose::from_translation(Vec3::X * 0.1),
        });
    }
    longer
}

/// The arm of `PlanarArm::KR125_SIZED` as links of round solids. Its joints are 0 at these planar angles; the third
/// turns in the opposite direction if `reversed`.
fn planar_robot(zero: [f64; 3], reversed: bool) -> Robot {
    let arm = PlanarArm::KR125_SIZED;
    let at = |x, z, pitch| Pose::from_xyz_rpy([x, 0.0, z], [0.0, pitch, 0.0]);
    let joint = |i: usize, origin: Pose, axis: Vec3, [lower, upper]: [f64; 2]| Joint {
        name: ["a", "b", "c"][i].into(),
        kind: JointKind::Revolute,
        parent: LinkId(i),
        child: LinkId(i + 1),
        origin,
        axis,
        limits: Limits { lower: lower.to_radians(), upper: upper.to_radians(), ..Limits::symmetric(1.0) },
        mimic: None,
    };
    let sense = if reversed { -1.0 } else { 1.0 };
    let third = if reversed { [-150.0, 120.0] } else { [-120.0, 150.0] };
    let joints = vec![
        joint(0, Pose::from_xyz_rpy([0.0; 3], [0.0, 0.0, zero[0]]), Vec3::Z, [-170.0, 170.0]),
        joint(1, at(arm.offset_m, arm.height_m, zero[1]), Vec3::Y, [-90.0, 90.0]),
        joint(2, at(0.0, arm.upper_length_m, zero[2]), Vec3::Y * sense, third),
    ];
    let links = (0..4).map(|i| format!("link_{i}")).collect();
    let mut robot = Robot::new(Chain::new("planar", links, joints).unwrap());
    let mut add = |link: usize, shape, in_link| {
        robot.colliders[link].push(Collider { name: String::new(), shape, in_link });
    };
    let half_length = 0.5 * arm.upper_length_m;
    add(2, Shape::Capsule(Capsule { half_length, radius: arm.upper_radius_m }), at(0.0, half_length, 0.0));
    let (half_length, radius) = (0.5 * arm.fore_length_m, arm.fore_radius_m);
    add(3, Shape::Cylinder(Cylinder { half_length, radius }), at(half_length, 0.0, std::f64::consts::FRAC_PI_2));
    add(3, Shape::Sphere(Sphere { radius }), Pose::IDENTITY);
    add(3, Shape::Sphere(Sphere { radius: arm.wrist_radius_m }), at(arm.fore_length_m, 0.0, 0.0));
    robot
}

#[test]
fn arms_in_a_plane_have_the_planar_filler() {
    for (zero, reversed) in [([0.0; 3], false), ([0.4, 0.3, -0.7], false), ([0.0, -0.2, 0.5], true)] {
        let mut case = Case::new(vec![
            cuboid([1.3, 0.4, 0.9], [0.0, 0.0, 0.5], [0.5, 0.4, 0.6]),
            (Shape::Sphere(Sphere { radius: 0.25 }), Pose::from_xyz_rpy([0.9, -0.6, 1.4], [0.0; 3])),
            (
                Shape::Cylinder(Cylinder { half_length: 0.3, radius: 0.2 }),
                Pose::from_xyz_rpy([-1.2, 0.3, 0.6], [0.0; 3]),
            ),
        ]);
        case.robot = planar_robot(zero, reversed);
        case.base = Pose::from_xyz_rpy([0.1, -0.05, 0.02], [0.1, 0.2, 0.3]);
        case.step = 5.0;
        assert!(builder(&case, &grid(&case), CoverMapSettings::default()).is_planar());
        check(&case, 20_000);
        case.robot.colliders[2][0].in_link.translation.y = 0.01;
        assert!(!builder(&case, &grid(&case), CoverMapSettings::default()).is_planar());
    }
}

#[test]
fn an_axis_of_more_than_a_turn_repeats() {
    let mut case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    let mut joints = case.robot.chain.joints().to_vec();
    for joint in &mut joints {
        (joint.limits.lower, joint.limits.upper) = (-6.0, 6.6);
    }
    let links = case.robot.chain.links().to_vec();
    let colliders = case.robot.colliders.clone();
    case.robot = Robot::new(Chain::new("turns", links, joints).unwrap());
    case.robot.colliders = colliders;
    case.step = 10.0;
    check(&case, 20_000);
}

/// A source that counts the covers that it builds.
#[derive(Default)]
struct CountedCovers(std::sync::atomic::AtomicUsize);

impl CoverSource for CountedCovers {
    fn cover(&self, shapes: &[(&Shape, Pose)], slack_m: f64) -> Option<SphereCover> {
        self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        SphereCover::new(shapes, slack_m)
    }
}

#[test]
fn covers_come_from_the_source() {
    let case = Case::new(vec![cuboid([0.6, 0.2, 0.5], [0.3, 0.2, 0.8], [0.2, 0.1, 0.3])]);
    let (grid, settings, source) = (grid(&case), CoverMapSettings::default(), CountedCovers::default());
    let remaining = RemainingJoints::Swept;
    let built = CoverMapBuilder::new(&case.robot, case.base, &grid, [0, 1, 2], remaining, settings).unwrap();
    let given =
        CoverMapBuilder::with_covers(&case.robot, case.base, &grid, [0, 1, 2], remaining, settings, &source).unwrap();
    assert!(source.0.into_inner() >= 3, "a cover per link");
    let (shape, at) = &case.obstacles[0];
    let layer = |builder: &CoverMapBuilder| builder.layer(&builder.obstacle(shape).unwrap(), at).unwrap();
    assert_eq!(layer(&built).spans(), layer(&given).spans());
}

#[test]
fn invalid_input_is_rejected() {
    let robot = example::arm().unwrap();
    let grid = Grid::new(["a", "b", "c"].map(|n| GridAxis::from_degrees(n, -90.0, 90.0, 5.0).unwrap())).unwrap();
    let settings = CoverMapSettings::default();
    let builder =
        CoverMapBuilder::new(&robot, Pose::IDENTITY, &grid, [0, 1, 2], RemainingJoints::Swept, settings).unwrap();
    assert!(builder.obstacle(&Shape::Sphere(Sphere { radius: f64::NAN })).is_err());
    let ball = builder.obstacle(&Shape::Sphere(Sphere { radius: 0.1 })).unwrap();
    let nowhere = Pose::from_translation(Vec3::new(f64::NAN, 0.0, 0.0));
    assert!(matches!(builder.layer(&ball, &nowhere), Err(RobotMapError::InvalidPlacement(_))));
    let new = |joints| CoverMapBuilder::new(&robot, Pose::IDENTITY, &grid, joints, RemainingJoints::Swept, settings);
    assert!(new([0, 1, 1]).is_err() && new([0, 1, 7]).is_err());
    for slack_m in [0.0, -0.001, f64::NAN, f64::INFINITY] {
        let settings = CoverMapSettings { slack_m: Some(slack_m), ..CoverMapSettings::default() };
        let remaining = RemainingJoints::Swept;
        let refused = CoverMapBuilder::new(&robot, Pose::IDENTITY, &grid, [0, 1, 2], remaining, settings);
        assert!(matches!(refused, Err(RobotMapError::Slack(_))), "{slack_m}");
    }
    for clearance_m in [-0.001, f64::NAN, f64::INFINITY] {
        let settings = CoverMapSettings { clearance_m, ..CoverMapSettings::default() };
        let remaining = RemainingJoints::Swept;
        let refused = CoverMapBuilder::new(&robot, Pose::IDENTITY, &grid, [0, 1, 2], remaining, settings);
        assert!(matches!(refused, Err(RobotMapError::Clearance(_))), "{clearance_m}");
    }
}
