//! Answers against the exact scene: proven free never collides, proven hit always does.
//!
//! `ELBOWROOM_VALIDITY_STATES=1000000` compares as many configurations (and an eighth as many edges, at most) over all robots of
//! the data, in the release profile best: `cargo test --release -p elbowroom-validity --test against_scene -- --nocapture`.

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
    edges: usize,
    proven_edges: usize,
    free_edges: usize,
}

impl Counts {
    fn add(&mut self, other: &Self) {
        self.free += other.free;
        self.hit += other.hit;
        self.uncertain += other.uncertain;
        self.uncertain_free += other.uncertain_free;
        self.edges += other.edges;
        self.proven_edges += other.proven_edges;
        self.free_edges += other.free_edges;
    }
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
        counts.edges += 1;
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
        all.add(&counts);
    }
    println!("{all:?}");
    assert!(all.free > 500 && all.hit > 500, "{all:?}");
    // The covers settle most of it.
    assert!(all.uncertain * 4 < all.free + all.hit, "{all:?}");
    assert!(all.proven_edges * 10 > all.free_edges * 7, "{all:?}");
}

/// Total number of configurations on real robots, where it is set.
fn states_wanted() -> Option<usize> {
    std::env::var("ELBOWROOM_VALIDITY_STATES").ok().map(|n| n.parse().expect("ELBOWROOM_VALIDITY_STATES is a number"))
}

/// Folders of the robots to compare: a few, or all of the data.
fn robot_folders(data: &std::path::Path) -> Vec<std::path::PathBuf> {
    let urdf = data.join("urdf");
    if states_wanted().is_none() {
        return ["panda", "ur5e", "kuka_kr150_2", "staubli_tx60"].map(|name| urdf.join(name)).to_vec();
    }
    let mut all: Vec<_> = std::fs::read_dir(urdf).unwrap().map(|entry| entry.unwrap().path()).collect();
    all.sort();
    all.retain(|folder| urdf_in(folder).is_some());
    all
}

#[test]
fn real_robots_among_random_obstacles() {
    let Some(data) = common::data() else { return };
    let mut random = Random(11);
    let folders = robot_folders(&data);
    let per_robot = states_wanted().map_or(1000, |n| n.div_ceil(folders.len()));
    let mut all = Counts::default();
    for folder in folders {
        let path = urdf_in(&folder).unwrap_or_else(|| panic!("no URDF in {}", folder.display()));
        let srdf = Some(path.with_extension("srdf")).filter(|p| p.is_file());
        let options = elbowroom_formats::robot::LoadOptions { srdf, ..Default::default() };
        let robot = elbowroom_formats::robot::load(&path, &options).unwrap().robot;
        let begin = std::time::Instant::now();
        let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
        let built = begin.elapsed();
        let mut counts = Counts::default();
        let mut left = per_robot;
        // New obstacles every thousand configurations.
        while left > 0 {
            let solids = obstacles(&mut random, 14, 1.5);
            let scene = scene(&robot, Pose::IDENTITY, &solids);
            let set = obstacle_set(&solids);
            counts.add(&compare(&mut random, &robot, &scene, &covered, &set, left.min(1000)));
            left -= left.min(1000);
        }
        println!("{}: built in {built:?}, {counts:?}", path.file_stem().unwrap_or_default().to_string_lossy());
        all.add(&counts);
    }
    println!("{all:?}");
}

fn urdf_in(folder: &std::path::Path) -> Option<std::path::PathBuf> {
    let mut all: Vec<_> = std::fs::read_dir(folder).ok()?.filter_map(|e| Some(e.ok()?.path())).collect();
    all.sort();
    all.into_iter().find(|p| p.extension().is_some_and(|e| e == "urdf") && !p.to_string_lossy().contains(".package."))
}
