//! Boxes in joint space proven to be in collision: every configuration in them collides in the exact scene.

use crate::common::{ROBOT, Random, RandomGeometry, obstacle_set, obstacles, scene, single_joint};
use elbowroom_kinematics::{Chain, JointKind, Limits};
use elbowroom_proximity::{Shape, Sphere};
use elbowroom_robot::{Collider, Robot, example};
use elbowroom_scene::{Checker, CheckerOptions, SceneState};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::extent::amount;
use elbowroom_validity::{CoveredRobot, ObstacleSet, ValidityChecker, ValidityError};

#[test]
fn every_configuration_of_a_proven_box_collides() {
    let mut random = Random(21);
    let (mut proven, mut narrow) = (0, 0);
    // All robots share the obstacles: covering these takes longer than the rest of the test.
    let surroundings = [3, 10, 24].map(|count| obstacles(&mut random, count, 0.8));
    let sets = surroundings.each_ref().map(|solids| obstacle_set(solids));
    let rounds = amount(6, 18);
    for round in 0..rounds {
        let joints = 2 + random.index(5);
        let robot = random.robot(joints);
        let base = random.pose(0.5);
        let scene = scene(&robot, base, &surroundings[round % 3]);
        let covered = CoveredRobot::new(&robot, base).unwrap();
        let mut checker = ValidityChecker::new(&covered, &sets[round % 3]);
        let mut exact = Checker::new(&scene, CheckerOptions::default());
        let mut state = SceneState::new(&scene);
        // In every other round some joints may have any value within their limits, the last joint always.
        let (lower, upper) = (robot.chain.lower(), robot.chain.upper());
        let mut whole: Vec<bool> = lower.iter().map(|low| low.is_finite() && random.index(3) == 0).collect();
        match whole.last_mut() {
            Some(last) if round % 2 == 1 => *last = lower.last().is_some_and(|low| low.is_finite()),
            _ => whole.fill(false),
        }
        let width = random.between(0.002, 0.08);
        let half: Vec<f64> = (0..lower.len()).map(|i| if whole[i] { f64::INFINITY } else { width }).collect();
        let centres: Vec<f64> = (0..100).flat_map(|_| random.q(&robot.chain)).collect();
        let mut answers = Vec::new();
        checker.boxes_are_in_collision(&centres, &half, &mut answers).unwrap();
        assert_eq!(answers.len(), 100);
        for (centre, _) in centres.chunks(lower.len()).zip(&answers).filter(|(_, proven)| **proven) {
            proven += 1;
            narrow += usize::from(whole.iter().all(|w| !w));
            for _ in 0..20 {
                // The corners are farthest from the centre. Slides stay within their limits.
                let within = |i: usize, c: f64| {
                    if whole[i] { (lower[i], upper[i]) } else { ((c - width).max(lower[i]), (c + width).min(upper[i])) }
                };
                let q: Vec<f64> = (0..centre.len())
                    .map(|i| within(i, centre[i]))
                    .map(|(low, high)| [low, high, random.between(low, high)][random.index(3)])
                    .collect();
                state.set_q(&scene, ROBOT, &q).unwrap();
                assert!(
                    exact.collides(&state).is_some(),
                    "round {round}: {q:?} is free, within {half:?} of {centre:?}"
                );
            }
        }
    }
    assert!(
        3 * proven > 20 * rounds && narrow > 0 && narrow < proven,
        "{proven} proven, {narrow} of them with all joints narrow"
    );
}

#[test]
fn numbers_that_are_none_prove_nothing_and_wrong_counts_are_errors() {
    let arm = CoveredRobot::new(&example::arm().unwrap(), Pose::IDENTITY).unwrap();
    let set = obstacle_set(&obstacles(&mut Random(3), 12, 0.5));
    let mut checker = ValidityChecker::new(&arm, &set);
    let mut answers = Vec::new();
    checker.boxes_are_in_collision(&[0.0; 3], &[0.0; 3], &mut answers).unwrap();
    assert_eq!(answers, [true], "nothing is near");
    let anything = [f64::NAN, f64::INFINITY, -1.0];
    for odd in anything {
        checker.boxes_are_in_collision(&[odd; 3], &[0.0; 3], &mut answers).unwrap();
        assert!(odd == -1.0 || answers == [false]);
        checker.boxes_are_in_collision(&[0.0; 6], &[odd; 3], &mut answers).unwrap();
        assert_eq!(answers, [false, false]);
    }
    for (centres, half) in [(2, 3), (3, 2), (3, 6), (4, 3)] {
        let error = checker.boxes_are_in_collision(&vec![0.0; centres], &vec![0.1; half], &mut answers).unwrap_err();
        assert!(matches!(error, ValidityError::WrongCount { expected: 3, .. }), "{error}");
    }
    let nothing = ObstacleSet::default();
    let mut alone = ValidityChecker::new(&arm, &nothing);
    alone.boxes_are_in_collision(&[], &[0.0; 3], &mut answers).unwrap();
    assert!(answers.is_empty());
}

/// The bounds of motion hold within the limits of slides: if any joint is beyond them, nothing is proven.
#[test]
fn a_box_around_a_joint_beyond_its_limits_proves_nothing() {
    let joints = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate().map(|(i, axis)| {
        let limits = Limits::symmetric(0.5);
        elbowroom_kinematics::Joint { limits, ..single_joint(i, JointKind::Prismatic, Pose::IDENTITY, axis) }
    });
    let links = (0..4).map(|i| format!("l{i}")).collect();
    let mut robot = Robot::new(Chain::new("gantry", links, joints.collect()).unwrap());
    let ball = |radius| Shape::Sphere(Sphere { radius });
    robot.colliders[3].push(Collider { name: String::new(), shape: ball(0.2), in_link: Pose::IDENTITY });
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
    let set = obstacle_set(&[(ball(1.0), Pose::IDENTITY)]);
    let mut checker = ValidityChecker::new(&covered, &set);
    let mut answers = Vec::new();
    for joint in 0..3 {
        let mut centres = vec![0.0; 6];
        centres[3 + joint] = 0.6;
        checker.boxes_are_in_collision(&centres, &[0.01; 3], &mut answers).unwrap();
        assert_eq!(answers, [true, false], "joint {joint}");
    }
}
