//! Edges that are rejected together: never a free one, many of those in obstacles, and the same on every instruction set.

use crate::common::{Random, RandomGeometry, obstacle_set, obstacles};
use crate::instruction_sets::simd_levels;
use elbowroom_spatial::Pose;
use elbowroom_validity::{CoveredLinkId, CoveredRobot, EDGES_AT_ONCE, ValidityChecker, ValidityError};

#[test]
fn no_rejected_edge_is_free_and_many_that_are_not_are_rejected() {
    let levels = simd_levels();
    let mut random = Random(77);
    let mut rejected = 0;
    for round in 0..6 {
        let joints = 3 + random.index(5);
        let robot = random.robot(joints);
        let set = obstacle_set(&obstacles(&mut random, [4, 30][round % 2], 1.5));
        let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
        let mut checkers: Vec<_> =
            levels.iter().map(|level| ValidityChecker::new(&covered, &set).with_simd_level(*level)).collect();
        if round == 5 {
            let last = CoveredLinkId(covered.covered_links().len() - 1);
            for checker in &mut checkers {
                checker.skip(last, 0);
            }
        }
        for _ in 0..40 {
            let count = 1 + random.index(EDGES_AT_ONCE);
            let ends: Vec<_> = (0..count).map(|_| [random.q(&robot.chain), random.q(&robot.chain)]).collect();
            let edges: Vec<_> = ends.iter().map(|[from, to]| (&from[..], &to[..])).collect();
            let bits = checkers[0].edges_in_obstacles(&edges).unwrap();
            for (index, (from, to)) in edges.iter().enumerate() {
                let is_free = checkers[0].edge_is_free(from, to).unwrap();
                let is_rejected = bits >> index & 1 == 1;
                assert!(!(is_free && is_rejected), "round {round}: {from:?} {to:?}");
                rejected += usize::from(is_rejected);
            }
            for checker in &mut checkers[1..] {
                assert_eq!(checker.edges_in_obstacles(&edges).unwrap(), bits);
            }
        }
    }
    // Of 720 edges 558 are not free, most of them because links meet.
    assert!(rejected > 50, "{rejected}");
}

#[test]
fn unusable_edges_are_refused_or_have_no_bit() {
    let mut random = Random(3);
    let robot = random.robot(4);
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
    let set = obstacle_set(&obstacles(&mut random, 30, 1.5));
    let mut checker = ValidityChecker::new(&covered, &set);
    let q = random.q(&robot.chain);
    let unknown = vec![f64::NAN; q.len()];
    let endless = vec![f64::INFINITY; q.len()];
    let alone = checker.edges_in_obstacles(&[(&q, &q)]).unwrap();
    assert_eq!(checker.edges_in_obstacles(&[(&unknown, &q), (&q, &q), (&q, &endless)]).unwrap(), alone << 1);
    assert_eq!(checker.edges_in_obstacles(&[]).unwrap(), 0);
    let too_few = checker.edges_in_obstacles(&[(&q, &q[1..])]);
    assert!(matches!(too_few, Err(ValidityError::WrongCount { found, expected }) if found + 1 == expected));
}
