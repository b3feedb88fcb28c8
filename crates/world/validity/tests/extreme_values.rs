//! Extreme values: unlimited slides, huge angles, distant bases and solids, empty robots and obstacle sets.

use std::sync::Arc;

use crate::common::{Random, RandomGeometry, single_joint};
use elbowroom_kinematics::{Chain, ChainState, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::{Capsule, Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh};
use elbowroom_robot::{Collider, Robot};
use elbowroom_spatial::{Pose, Rotation, Vec3};
use elbowroom_validity::{
    CoveredLinkId, CoveredRobot, ObstacleSet, SphereCover, Validity, ValidityChecker, ValidityError,
};

fn sphere(radius: f64) -> Shape {
    Shape::Sphere(Sphere { radius })
}

fn ball_set(centre: Vec3, radius: f64) -> ObstacleSet {
    let mut set = ObstacleSet::default();
    set.add_shape(&sphere(radius), &Pose::from_translation(centre), 0.0);
    set
}

/// Joints in a row, each with its origin, axis and limits, and a ball of 5 cm in the last link.
fn serial(joints: &[(JointKind, Vec3, Vec3, Limits)], ball_at: Vec3) -> Robot {
    let list: Vec<Joint> = joints
        .iter()
        .enumerate()
        .map(|(i, &(kind, origin, axis, limits))| Joint {
            limits,
            ..single_joint(i, kind, Pose::from_translation(origin), axis)
        })
        .collect();
    let links = (0..=list.len()).map(|i| format!("link {i}")).collect();
    let mut robot = Robot::new(Chain::new("serial", links, list).unwrap());
    let collider = Collider { name: String::new(), shape: sphere(0.05), in_link: Pose::from_translation(ball_at) };
    robot.colliders[joints.len()].push(collider);
    robot
}

/// A revolute joint about z, then a slide along z without limits; the ball is half a metre from the axis.
fn unlimited_slide(axis: Vec3) -> Robot {
    let turn = (JointKind::Revolute, Vec3::ZERO, Vec3::Z, Limits::symmetric(6.0));
    let slide = (JointKind::Prismatic, Vec3::ZERO, axis, Limits::UNLIMITED);
    serial(&[turn, slide], Vec3::X * 0.5)
}

#[test]
fn an_edge_of_an_unlimited_slide_does_not_pass_between_its_samples() {
    let robot = unlimited_slide(Vec3::Z);
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
    // Midway between two of the sixteen configurations of the edge.
    let angle = 4.4 / 15.0 * 5.5;
    let set = ball_set(Vec3::new(0.5 * f64::cos(angle), 0.5 * f64::sin(angle), 0.0), 0.015);
    let mut checker = ValidityChecker::new(&covered, &set);
    assert_ne!(checker.state(&[angle, 0.0]), Ok(Validity::Free));
    assert_eq!(checker.edge_is_free(&[0.0, 0.0], &[4.4, 0.0]), Ok(false));
}

#[test]
fn edges_of_an_unlimited_slide_end_and_are_proven() {
    for axis in [Vec3::Z, Vec3::X, Vec3::new(0.6, 0.0, 0.8)] {
        let covered = CoveredRobot::new(&unlimited_slide(axis), Pose::IDENTITY).unwrap();
        let set = ball_set(Vec3::new(-0.9, 0.0, 0.0), 0.1);
        let mut checker = ValidityChecker::new(&covered, &set);
        assert_eq!(checker.edge_is_free(&[0.0, 0.0], &[0.4, 0.3]), Ok(true), "{axis:?}");
    }
}

#[test]
fn a_slide_beyond_all_numbers_spoils_no_other_lane() {
    let covered = CoveredRobot::new(&unlimited_slide(Vec3::Z), Pose::IDENTITY).unwrap();
    let set = ball_set(Vec3::X * 0.5, 0.02);
    let mut checker = ValidityChecker::new(&covered, &set);
    for huge in [1e9, 1e20, 1e39, 1e300, f64::INFINITY, f64::NAN] {
        let mut answers = Vec::new();
        checker.states(&[0.0, 0.0, 0.0, huge, 2.0, 0.0], &mut answers).unwrap();
        assert_eq!(answers, [Validity::Hit, Validity::Uncertain, Validity::Free], "{huge}");
        assert_eq!(checker.edge_is_free(&[2.0, 0.0], &[2.0, huge]), Ok(false), "{huge}");
    }
}

#[test]
fn slides_beyond_their_limits_are_not_certain() {
    let turn = (JointKind::Revolute, Vec3::ZERO, Vec3::Z, Limits::symmetric(3.0));
    let slide = (JointKind::Prismatic, Vec3::ZERO, Vec3::X, Limits::range(0.0, 0.05));
    let mut robot = serial(&[turn, slide], Vec3::X * 0.5);
    // A ball of the base that the slide reaches only outside its limits: only the table of the pair can detect it.
    let collider =
        Collider { name: String::new(), shape: sphere(0.05), in_link: Pose::from_translation(Vec3::X * 1.5) };
    robot.colliders[0].push(collider);
    let mut covered = CoveredRobot::without_pairs(&robot, Pose::IDENTITY).unwrap();
    covered.add_pair(CoveredLinkId(0), CoveredLinkId(1), 0.0);
    let set = ObstacleSet::default();
    let mut checker = ValidityChecker::new(&covered, &set);
    assert_eq!(checker.state(&[0.0, 0.05]), Ok(Validity::Free));
    assert_eq!(checker.state(&[0.0, 0.05 + 1e-6]), Ok(Validity::Free), "rounding of limits");
    assert_ne!(checker.state(&[0.0, 1.0]), Ok(Validity::Free));
    assert_eq!(checker.edge_is_free(&[0.0, 0.04], &[0.0, 1.0]), Ok(false));
    assert_eq!(checker.edge_is_free(&[0.0, 1.0], &[0.0, 1.01]), Ok(false));
    let mut found = Vec::new();
    checker.uncertain_pairs(&[0.0, 0.99], &[0.0, 1.01], &mut found).unwrap();
    assert_eq!(found.len(), 1);
}

#[test]
fn huge_angles_are_where_double_precision_puts_them() {
    let turn = (JointKind::Continuous, Vec3::ZERO, Vec3::Z, Limits::UNLIMITED);
    let robot = serial(&[turn], Vec3::X * 0.5);
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
    let mut random = Random(3);
    for size in [1.0, 1e3, 1e6, 1e8, 1e10, 1e12, 1e15, 1e17, 1e30, 1e300] {
        for _ in 0..50 {
            let angle = random.between(-size, size);
            let (sin, cos) = angle.sin_cos();
            let set = ball_set(Vec3::new(0.5 * cos, 0.5 * sin, 0.05 + 0.02 - 1e-6), 0.02);
            let mut checker = ValidityChecker::new(&covered, &set);
            assert_ne!(checker.state(&[angle]), Ok(Validity::Free), "{angle}");
            assert_eq!(checker.edge_is_free(&[angle], &[angle + 0.1]), Ok(false), "{angle}");
        }
    }
}

/// Balls that overlap by a micrometre, at random configurations of a chain with a base somewhere.
fn balls_that_just_touch(base: Vec3, reach: f64, random: &mut Random) {
    let joints = 2 + random.index(9);
    let list: Vec<Joint> = (0..joints)
        .map(|i| {
            let kind = [JointKind::Revolute, JointKind::Continuous, JointKind::Prismatic][random.index(3)];
            let limits = Limits::symmetric(if kind == JointKind::Prismatic { reach } else { 3.0 });
            let (origin, axis) = (random.pose(reach), random.vec3(1.0).try_normalize().unwrap_or(Vec3::Z));
            Joint { limits, ..single_joint(i, kind, origin, axis) }
        })
        .collect();
    let links = (0..=joints).map(|i| format!("link {i}")).collect();
    let chain = Chain::new("random", links, list).unwrap();
    let base = Pose::new(random.rotation(), base);
    let q = random.q(&chain);
    let mut state = ChainState::new(&chain);
    state.q.copy_from_slice(&q);
    chain.forward(&mut state);
    let (first, last) = (1 + random.index(joints - 1), joints);
    let (at_first, at_last) = (random.vec3(reach), random.vec3(reach));
    let in_world = |link: usize, p: Vec3| base.transform_point(state.link_in_root(LinkId(link)).transform_point(p));
    let distance = in_world(first, at_first).distance(in_world(last, at_last));
    let mut covered = CoveredRobot::without_pairs(&Robot::new(chain.clone()), base).unwrap();
    let one =
        covered.add_covered_link(&chain, LinkId(first), &[(&sphere(0.5 * distance), Pose::from_translation(at_first))]);
    let shape = sphere(0.5 * distance + 1e-6 * reach);
    let other = covered.add_covered_link(&chain, LinkId(last), &[(&shape, Pose::from_translation(at_last))]);
    let nothing = ObstacleSet::default();
    let (one, other) = (one.unwrap(), other.unwrap());
    let among = |covered: &CoveredRobot, set: &ObstacleSet| {
        let mut checker = ValidityChecker::new(covered, set);
        let near: Vec<f64> = q.iter().map(|v| v * 0.99).collect();
        (checker.state(&q).unwrap(), checker.edge_is_free(&near, &q).unwrap())
    };
    let alone = among(&covered, &nothing);
    assert_eq!(alone, (Validity::Free, true), "without pairs");
    let direction = random.vec3(1.0).try_normalize().unwrap_or(Vec3::Z);
    let obstacle = 0.3 * reach;
    let centre = in_world(last, at_last) + direction * (0.5 * distance + obstacle);
    let found = among(&covered, &ball_set(centre, obstacle));
    assert!(found.0 != Validity::Free && !found.1, "an obstacle, base at {base:?}, q {q:?}");
    covered.add_pair(one, other, 0.0);
    let found = among(&covered, &nothing);
    assert!(found.0 != Validity::Free && !found.1, "two covered_links, base at {base:?}, q {q:?}");
}

#[test]
fn a_contact_of_a_micrometre_is_found_wherever_the_base_is() {
    let mut random = Random(8);
    for far in [0.0, 1.0, 100.0, 1e4] {
        for reach in [0.01, 0.3, 5.0, 60.0] {
            for _ in 0..60 {
                let base = random.vec3(far);
                balls_that_just_touch(base, reach, &mut random);
            }
        }
    }
}

#[test]
fn a_base_beyond_all_numbers_is_an_error() {
    let robot = unlimited_slide(Vec3::X);
    for far in [1e12, 1e25, 1e39, f64::INFINITY, f64::NAN] {
        let covered = CoveredRobot::new(&robot, Pose::from_translation(Vec3::X * far));
        assert!(matches!(covered, Err(ValidityError::NotCovered { .. })), "{far}");
    }
}

#[test]
fn huge_obstacles_and_margins_are_never_free_by_overflow() {
    let covered = CoveredRobot::new(&unlimited_slide(Vec3::Z), Pose::IDENTITY).unwrap();
    let is_free = |set: &ObstacleSet| {
        let mut checker = ValidityChecker::new(&covered, set);
        checker.state(&[0.0, 0.0]).unwrap() == Validity::Free || checker.edge_is_free(&[0.0, 0.0], &[0.1, 0.1]).unwrap()
    };
    for size in [10.0, 1e4, 1e7, 1e10, 1e20, 1e25, 1e39] {
        let shapes = [
            sphere(size),
            Shape::Capsule(Capsule { half_length: size, radius: size }),
            Shape::Cylinder(Cylinder { half_length: size, radius: size }),
            Shape::Cuboid(Cuboid { half_extents: Vec3::splat(size) }),
        ];
        for shape in shapes {
            let mut set = ObstacleSet::default();
            set.add_shape(&shape, &Pose::from_translation(Vec3::X * (size + 0.549)), 0.0);
            assert!(!is_free(&set), "{shape:?}");
            // A ball beside the robot's ball, with a margin.
            let mut set = ObstacleSet::default();
            let small = Pose::from_translation(Vec3::new(0.5, 0.05 + 0.01 + size * (1.0 - 1e-7), 0.0));
            set.add_shape(&sphere(0.01), &small, size);
            assert!(!is_free(&set), "margin {size}");
        }
        let mut set = ObstacleSet::default();
        set.add_points(&[Vec3::X * (size + 0.549)], size);
        assert!(!is_free(&set), "a point of {size} m");
        // A plane, rotated about the contact and given at a distant point of the plane.
        let rotation = Rotation::from_axis_angle(Vec3::X, 0.3);
        let at = Vec3::X * 0.5 + rotation * Vec3::new(size, 0.0, -0.049);
        let mut set = ObstacleSet::default();
        set.add_shape(&Shape::HalfSpace(HalfSpace), &Pose::new(rotation, at), 0.0);
        assert!(!is_free(&set), "half-space at {at:?}");
    }
}

#[test]
fn large_margins_of_pairs_keep_their_last_digits() {
    let robot = serial(&[(JointKind::Prismatic, Vec3::ZERO, Vec3::X, Limits::symmetric(0.5))], Vec3::ZERO);
    let mut covered = CoveredRobot::without_pairs(&robot, Pose::IDENTITY).unwrap();
    let margin = 1000.0;
    let at = Vec3::new(0.6, 0.0, 0.8) * (margin + 0.1 - 2e-6);
    let ball = (&sphere(0.05), Pose::from_translation(at));
    let other = covered.add_covered_link(&robot.chain, LinkId(0), &[ball]).unwrap();
    covered.add_pair(CoveredLinkId(0), other, margin);
    let set = ObstacleSet::default();
    assert_ne!(ValidityChecker::new(&covered, &set).state(&[0.0]), Ok(Validity::Free));
}

#[test]
fn a_mimic_that_stands_still_follows_an_unlimited_joint() {
    let mut joints = vec![
        single_joint(0, JointKind::Continuous, Pose::IDENTITY, Vec3::Z),
        single_joint(1, JointKind::Prismatic, Pose::IDENTITY, Vec3::X),
    ];
    joints[1].limits = Limits::UNLIMITED;
    joints[1].mimic = Some(Mimic { joint: JointId(0), multiplier: 0.0, offset: 0.5 });
    let links = (0..3).map(|i| format!("link {i}")).collect();
    let mut robot = Robot::new(Chain::new("mimic", links, joints).unwrap());
    robot.colliders[2].push(Collider { name: String::new(), shape: sphere(0.05), in_link: Pose::IDENTITY });
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
    let angle = 4.4 / 15.0 * 5.5;
    let set = ball_set(Vec3::new(0.5 * f64::cos(angle), 0.5 * f64::sin(angle), 0.0), 0.015);
    let mut checker = ValidityChecker::new(&covered, &set);
    assert_eq!(checker.edge_is_free(&[0.0], &[4.4]), Ok(false));
    assert_eq!(checker.state(&[angle]), Ok(Validity::Hit));
    assert_eq!(checker.state(&[angle + 1.0]), Ok(Validity::Free));
}

#[test]
fn meshes_far_away_are_covered_or_refused() {
    let corners = |size: f64, at: Vec3| {
        let p = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|v| v * size + at);
        TriMesh::new(p.to_vec(), vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).map(|m| Shape::Mesh(Arc::new(m)))
    };
    for size in [1e-9, 1e-4, 0.05, 1e6, 1e12, 1e30] {
        for far in [0.0, 1.0, 1e3, 1e6, 1e9, 1e12, 1e15, 1e30, 1e300] {
            let Ok(shape) = corners(size, Vec3::splat(1.0) * far) else { continue };
            let Some(cover) = SphereCover::new(&[(&shape, Pose::IDENTITY)], 0.005) else { continue };
            let Shape::Mesh(mesh) = &shape else { unreachable!() };
            for &p in mesh.vertices() {
                assert!(cover.outer.iter().any(|b| b.contains(p)), "size {size}, at {far}");
            }
            let robot = unlimited_slide(Vec3::Z);
            let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
            let mut set = ObstacleSet::default();
            set.add_shape(&shape, &Pose::from_translation(Vec3::X * 0.5 - Vec3::splat(1.0) * far), 0.0);
            let answer = ValidityChecker::new(&covered, &set).state(&[0.0, 0.0]).unwrap();
            assert_ne!(answer, Validity::Free, "size {size}, at {far}");
        }
    }
}

#[test]
fn robots_and_sets_without_anything() {
    let nothing = ObstacleSet::default();
    let bare = Robot::new(Chain::new("bare", vec!["base".into()], vec![]).unwrap());
    let covered = CoveredRobot::new(&bare, Pose::IDENTITY).unwrap();
    let mut checker = ValidityChecker::new(&covered, &nothing);
    assert_eq!(checker.state(&[]), Ok(Validity::Free));
    assert_eq!(checker.edge_is_free(&[], &[]), Ok(true));
    assert!(matches!(checker.state(&[0.0]), Err(ValidityError::WrongCount { found: 1, expected: 0 })));
    assert!(checker.states(&[0.0], &mut Vec::new()).is_err());

    let mut robot = unlimited_slide(Vec3::Z);
    robot.colliders[2].clear();
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
    let set = ball_set(Vec3::X * 0.5, 0.1);
    let mut checker = ValidityChecker::new(&covered, &set);
    assert_eq!(checker.state(&[0.0, 0.0]), Ok(Validity::Free));
    assert_eq!(checker.edge_is_free(&[0.0, 0.0], &[1.0, 1.0]), Ok(true));
    let mut answers = vec![Validity::Hit];
    checker.states(&[], &mut answers).unwrap();
    assert!(answers.is_empty());
    let mut found = Vec::new();
    checker.uncertain_pairs(&[0.0, 0.0], &[1.0, 1.0], &mut found).unwrap();
    assert!(found.is_empty());
}

#[test]
fn shapes_without_extent_are_covered() {
    let cases = [
        sphere(0.0),
        Shape::Capsule(Capsule { half_length: 0.0, radius: 0.0 }),
        Shape::Capsule(Capsule { half_length: 0.1, radius: 0.0 }),
        Shape::Cylinder(Cylinder { half_length: 0.1, radius: 0.0 }),
        Shape::Cylinder(Cylinder { half_length: 0.0, radius: 0.1 }),
        Shape::Cuboid(Cuboid { half_extents: Vec3::ZERO }),
        Shape::Cuboid(Cuboid { half_extents: Vec3::X * 0.1 }),
    ];
    for shape in cases {
        let end = match &shape {
            Shape::Capsule(c) => Vec3::Z * c.half_length,
            Shape::Cylinder(c) => Vec3::new(c.radius, 0.0, c.half_length),
            Shape::Cuboid(c) => c.half_extents,
            _ => Vec3::ZERO,
        };
        if let Some(cover) = SphereCover::new(&[(&shape, Pose::IDENTITY)], 0.005) {
            assert!(cover.outer.iter().any(|b| b.contains(end)), "{shape:?}");
        }
        let covered = CoveredRobot::new(&unlimited_slide(Vec3::Z), Pose::IDENTITY).unwrap();
        let mut set = ObstacleSet::default();
        set.add_shape(&shape, &Pose::from_translation(Vec3::X * 0.5 - end), 0.0);
        let mut checker = ValidityChecker::new(&covered, &set);
        assert_ne!(checker.state(&[0.0, 0.0]), Ok(Validity::Free), "{shape:?}");
    }
}
