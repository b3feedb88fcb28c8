//! A checker remembers what ended the tests of edges; its answers do not depend on it.

use crate::common::{Random, RandomGeometry, obstacle_set, obstacles};
use elbowroom_spatial::Pose;
use elbowroom_validity::{CoveredRobot, ValidityChecker};

#[test]
fn answers_do_not_depend_on_edges_before() {
    let mut random = Random(91);
    let (mut free, mut not_free) = (0, 0);
    for round in 0..8 {
        let joints = 3 + random.index(5);
        let robot = random.robot(joints);
        let set = obstacle_set(&obstacles(&mut random, [3, 30][round % 2], 1.5));
        let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
        let fresh = ValidityChecker::new(&covered, &set);
        let mut used = fresh.clone();
        for _ in 0..60 {
            let from = random.q(&robot.chain);
            // Short edges from one configuration: many are free, and many touch the same.
            for _ in 0..4 {
                let to: Vec<f64> = from.iter().map(|value| value + random.between(-0.3, 0.3)).collect();
                let answer = used.edge_is_free(&from, &to).unwrap();
                assert_eq!(answer, fresh.clone().edge_is_free(&from, &to).unwrap(), "round {round}: {from:?} {to:?}");
                *(if answer { &mut free } else { &mut not_free }) += 1;
            }
        }
    }
    assert!(free > 100 && not_free > 100, "{free} {not_free}");
}
