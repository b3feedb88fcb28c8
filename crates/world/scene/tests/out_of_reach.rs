//! Pairs proven out of reach are really out of reach: objects are placed where a link certainly reaches, at random and at
//! the ends of its range.

use crate::common::{Random, RandomGeometry};

use elbowroom_kinematics::{Chain, ChainState, Joint, JointId, JointKind, Limits, LinkId, Mimic};
use elbowroom_proximity::{Capsule, Shape, Sphere};
use elbowroom_robot::{Collider, GeometryId, ObjectId, Robot, RobotId};

use elbowroom_scene::{Object, PairState, Reason, Scene};
use elbowroom_spatial::{Pose, Vec3};

/// Length of the rod of the last link, from its origin, m.
const LENGTH: f64 = 0.5;

/// `joints` joints of random kinds and axes, far apart or at one point; the last link has a rod.
///
/// Of three joints, the last may mimic the first.
fn arm(r: &mut Random, joints: usize) -> Robot {
    let follows = joints == 3 && r.unit() < 0.3;
    let joint = |i: usize, r: &mut Random| {
        let slides = r.unit() < 0.25;
        let middle = r.between(-0.5, 0.5);
        let offset = if r.unit() < 0.5 { 0.4 } else { 0.02 };
        Joint {
            name: format!("j{i}"),
            kind: if slides { JointKind::Prismatic } else { JointKind::Revolute },
            parent: LinkId(i),
            child: LinkId(i + 1),
            origin: Pose::from_translation(r.vec3(offset)),
            axis: [Vec3::X, Vec3::Y, Vec3::Z][(r.unit() * 3.0) as usize],
            limits: Limits::range(middle - r.between(0.2, 1.2), middle + r.between(0.2, 1.2)),
            mimic: (follows && i == 2).then_some(Mimic { joint: JointId(0), multiplier: -1.5, offset: 0.1 }),
        }
    };
    let links = (0..=joints).map(|i| format!("l{i}")).collect();
    let joints: Vec<Joint> = (0..joints).map(|i| joint(i, r)).collect();
    let mut robot = Robot::new(Chain::new("arm", links, joints).unwrap());
    let shape = Shape::Capsule(Capsule { half_length: LENGTH / 2.0, radius: 0.01 });
    let in_link = Pose::from_translation(Vec3::Z * (LENGTH / 2.0));
    robot.colliders.last_mut().unwrap().push(Collider { name: "rod".into(), shape, in_link });
    robot
}

/// A ball that the rod touches at some joint values within the limits.
fn ball(r: &mut Random, robot: &Robot) -> Object {
    let mut state = ChainState::new(&robot.chain);
    for (q, (lower, upper)) in state.q.iter_mut().zip(robot.chain.lower().into_iter().zip(robot.chain.upper())) {
        let share = [0.0, 1.0, r.unit(), r.unit()][(r.unit() * 4.0) as usize];
        *q = lower + share * (upper - lower);
    }
    robot.chain.forward(&mut state);
    let tip = LinkId(robot.chain.links().len() - 1);
    let at = state.link_in_root(tip).transform_point(Vec3::Z * (LENGTH * r.between(0.5, 1.0)));
    // Beside the rod's centre line, so that ball and rod barely touch.
    Object {
        name: "ball".into(),
        shape: Shape::Sphere(Sphere { radius: 0.015 }),
        in_world: Pose::from_translation(at + r.vec3(0.005)),
    }
}

#[test]
fn objects_that_a_link_touches_are_never_out_of_reach() {
    let mut r = Random(18);
    let mut proven = 0;
    for round in 0..600 {
        let robot = arm(&mut r, 1 + round % 4);
        let tip = GeometryId::Link { robot: RobotId(0), link: LinkId(robot.chain.links().len() - 1) };
        let mut builder = Scene::builder();
        builder.object(ball(&mut r, &robot));
        // A second ball anywhere, so that some pairs are proven.
        let far = Pose::from_translation(r.vec3(2.0));
        builder.object(Object { name: "far".into(), shape: Shape::Sphere(Sphere { radius: 0.05 }), in_world: far });
        builder.robot("arm", robot, Pose::IDENTITY);
        let scene = builder.build().unwrap();
        let entry = scene.allowed_collision_matrix().get(tip, GeometryId::Object(ObjectId(0))).unwrap();
        assert_eq!((entry.state, &entry.reason), (PairState::Tested, &Reason::Default), "round {round}");
        let far = scene.allowed_collision_matrix().get(tip, GeometryId::Object(ObjectId(1))).unwrap();
        proven += u32::from(matches!(far.reason, Reason::OutOfReach { .. }));
    }
    assert!(proven > 200, "{proven} were proven");
}

#[test]
fn links_of_two_robots_that_touch_are_never_out_of_reach() {
    let mut r = Random(19);
    for round in 0..200 {
        let (one, other) = (arm(&mut r, 1), arm(&mut r, 1 + round % 2));
        // The base of the second robot is placed so that the tips of the two rods meet at values within the limits of
        // both robots.
        let [a, b] = [&one, &other].map(|robot| ball(&mut r, robot).in_world.translation);
        let mut builder = Scene::builder();
        let tip = |robot: &Robot| LinkId(robot.chain.links().len() - 1);
        let (tip_a, tip_b) = (tip(&one), tip(&other));
        builder.robot("one", one, Pose::IDENTITY);
        builder.robot("other", other, Pose::from_translation(a - b));
        let scene = builder.build().unwrap();
        let entry = scene.allowed_collision_matrix().get(
            GeometryId::Link { robot: RobotId(0), link: tip_a },
            GeometryId::Link { robot: RobotId(1), link: tip_b },
        );
        assert_eq!(entry.unwrap().state, PairState::Tested, "round {round}");
    }
}
