//! Answers against the exact scene: proven free never collides, proven hit always does.

mod common;

use common::{ROBOT, Random, obstacle_set, obstacles, scene};
use elbowroom_robot::Robot;
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneState, SweepMove, SweepOptions};
use elbowroom_spatial::Pose;
use elbowroom_validity::{CoveredRobot, ObstacleSet, Validity, ValidityChecker};

#[derive(Default, Debug)]
struct Counts {
    free: usize,
    hit: usize,
    uncertain: usize,
    uncertain_free: usize,
    proven_edges: usize,
    free_edges: usize,
}

/// Compares random configurations and edges.
fn compare(
    random: &mut Random,
    robot: &Robot,
    scene: &Scene,
    covered: &CoveredRobot,
    set: &ObstacleSet,
    n: usize,
) -> Counts {
    let mut counts = Counts::default();
    let mut checker = ValidityChecker::new(covered, set);
    let mut exact = Checker::new(scene, CheckerOptions::default());
    let mut state = SceneState::new(scene);
    let chain = &robot.chain;
    let q: Vec<f64> = (0..n).flat_map(|_| random.q(chain)).collect();
    let mut answers = Vec::new();
    checker.states(&q, &mut answers).unwrap();
    for (q, &answer) in q.chunks(chain.dof()).zip(&answers) {
        state.set_q(scene, ROBOT, q).unwrap();
        let contact = exact.collides(&state);
        assert_eq!(checker.state(q).unwrap(), answer, "alone and in a block");
        match answer {
            Validity::Free => assert!(contact.is_none(), "proven free, but {contact:?} at {q:?}"),
            Validity::Hit => assert!(contact.is_some(), "proven hit, but free at {q:?}"),
            Validity::Uncertain => counts.uncertain_free += usize::from(contact.is_none()),
        }
        counts.free += usize::from(answer == Validity::Free);
        counts.hit += usize::from(answer == Validity::Hit);
        counts.uncertain += usize::from(answer == Validity::Uncertain);
    }
    let starts: Vec<&[f64]> =
        q.chunks(chain.dof()).zip(&answers).filter(|(_, a)| **a == Validity::Free).map(|(q, _)| q).collect();
    for from in starts.iter().take(n / 8) {
        let other = random.q(chain);
        let share = random.unit().powi(2);
        let to: Vec<f64> = from.iter().zip(&other).map(|(a, b)| a + share * (b - a)).collect();
        state.set_q(scene, ROBOT, from).unwrap();
        let moves = [SweepMove::Robot { robot: ROBOT, to: &to }];
        let hit = exact.sweep(&state, &moves, &SweepOptions::default()).unwrap();
        let proven = checker.edge_is_free(from, &to).unwrap();
        assert!(!proven || hit.is_none_or(|h| !h.certain), "proven free, but {hit:?} from {from:?} to {to:?}");
        counts.proven_edges += usize::from(proven);
        counts.free_edges += usize::from(hit.is_none());
    }
    counts
}

#[test]
fn random_robots_among_random_obstacles() {
    let mut random = Random(5);
    let mut all = Counts::default();
    for round in 0..24 {
        let joints = 2 + random.below(6);
        let robot = random.robot(joints);
        let base = random.pose(0.5);
        let count = [3, 12, 60][round % 3];
        let solids = obstacles(&mut random, count, 1.2);
        let scene = scene(&robot, base, &solids);
        let covered = CoveredRobot::new(&robot, base).unwrap();
        let set = obstacle_set(&solids);
        let counts = compare(&mut random, &robot, &scene, &covered, &set, 400);
        all.free += counts.free;
        all.hit += counts.hit;
        all.uncertain += counts.uncertain;
        all.uncertain_free += counts.uncertain_free;
        all.proven_edges += counts.proven_edges;
        all.free_edges += counts.free_edges;
    }
    println!("{all:?}");
    assert!(all.free > 500 && all.hit > 500, "{all:?}");
    // The covers settle most of it.
    assert!(all.uncertain * 4 < all.free + all.hit, "{all:?}");
    assert!(all.proven_edges * 10 > all.free_edges * 7, "{all:?}");
}

#[test]
fn real_robots_among_random_obstacles() {
    let Some(data) = common::data() else { return };
    let mut random = Random(11);
    for name in ["panda/panda", "ur5e/ur5e", "kuka_kr150_2/kr150_2", "staubli_tx60/tx60"] {
        let folder = data.join("urdf").join(name.split('/').next().unwrap());
        let Some(path) = urdf_in(&folder) else { panic!("no URDF in {}", folder.display()) };
        let robot =
            elbowroom_formats::robot::load(&path, &elbowroom_formats::robot::LoadOptions::default()).unwrap().robot;
        let solids = obstacles(&mut random, 14, 1.5);
        let scene = scene(&robot, Pose::IDENTITY, &solids);
        let begin = std::time::Instant::now();
        let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
        let built = begin.elapsed();
        let set = obstacle_set(&solids);
        let counts = compare(&mut random, &robot, &scene, &covered, &set, 1000);
        println!("{name}: built in {built:?}, {counts:?}");
    }
}

fn urdf_in(folder: &std::path::Path) -> Option<std::path::PathBuf> {
    let mut all: Vec<_> = std::fs::read_dir(folder).ok()?.filter_map(|e| Some(e.ok()?.path())).collect();
    all.sort();
    all.into_iter().find(|p| p.extension().is_some_and(|e| e == "urdf") && !p.to_string_lossy().contains(".package."))
}
