//! Answers against the exact scene: proven free never collides, proven hit always does.
//!
//! `ELBOWROOM_VALIDITY_STATES=1000000` compares as many configurations, and a tenth as many edges, over all robots of the data, in
//! the release profile best: `cargo test --release -p elbowroom-validity --test against_scene -- --nocapture`. With
//! `ELBOWROOM_VALIDITY_JOBS=DIRECTORY` it writes configurations and answers for Coal, see `xtask/planning/README.md`.

mod common;

use std::fmt::Write as _;

use common::{Kind, ROBOT, Random, Surroundings, coal_job, scene};
use elbowroom_robot::Robot;
use elbowroom_scene::{Checker, CheckerOptions, SceneState, SweepMove, SweepOptions};
use elbowroom_spatial::Pose;
use elbowroom_validity::{CoveredRobot, Validity, ValidityChecker};
use fearless_simd::Level as SimdLevel;

/// Configurations for each surroundings: of a short run, of a long one.
const ROUND: [usize; 2] = [500, 5000];
/// One configuration of so many, and one edge, is compared on instruction sets without fused sums, which are slow there.
const IN_SOFTWARE: usize = 500;

#[derive(Default, Debug, Clone, Copy)]
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

/// A robot among surroundings.
struct Comparison<'c> {
    robot: &'c Robot,
    base: Pose,
    covered: &'c CoveredRobot,
    surroundings: &'c Surroundings,
}

/// What a checker says: of configurations, of edges.
#[derive(Debug, PartialEq)]
struct Answers {
    states: Vec<Validity>,
    edges: Vec<bool>,
}

impl Comparison<'_> {
    /// Compares random configurations and edges with the exact scene, and instruction sets with each other.
    fn run(&self, random: &mut Random, states: usize, edges: usize) -> (Counts, Vec<f64>, Answers) {
        let set = self.surroundings.obstacle_set();
        let mut checker = ValidityChecker::new(self.covered, &set);
        let chain = &self.robot.chain;
        let q: Vec<f64> = (0..states).flat_map(|_| random.q(chain)).collect();
        let mut answers = Answers { states: Vec::new(), edges: Vec::new() };
        checker.states(&q, &mut answers.states).unwrap();
        let free = q.chunks(chain.dof()).zip(&answers.states).filter(|(_, a)| **a == Validity::Free).map(|(q, _)| q);
        let starts: Vec<&[f64]> = free.collect();
        let ends: Vec<(&[f64], Vec<f64>)> = starts
            .iter()
            .cycle()
            .take(if starts.is_empty() { 0 } else { edges })
            .map(|&from| {
                let (other, share) = (random.q(chain), random.unit().powi(2));
                (from, from.iter().zip(&other).map(|(a, b)| a + share * (b - a)).collect())
            })
            .collect();
        answers.edges = ends.iter().map(|(from, to)| checker.edge_is_free(from, to).unwrap()).collect();
        for (level, share) in other_simd_levels() {
            let mut checker = ValidityChecker::new(self.covered, &set).with_simd_level(level);
            let (n, m) = (states / share, ends.len() / share);
            let mut others = Vec::new();
            checker.states(&q[..n * chain.dof()], &mut others).unwrap();
            assert_eq!(others, answers.states[..n], "{level:?}");
            let others = ends[..m].iter().map(|(from, to)| checker.edge_is_free(from, to).unwrap());
            assert_eq!(others.collect::<Vec<_>>(), answers.edges[..m], "{level:?}");
        }
        (self.counts(&mut checker, &q, &ends, &answers), q, answers)
    }

    fn counts(
        &self,
        checker: &mut ValidityChecker,
        q: &[f64],
        ends: &[(&[f64], Vec<f64>)],
        answers: &Answers,
    ) -> Counts {
        let scene = scene(self.robot, self.base, &self.surroundings.as_solids());
        let mut exact = Checker::new(&scene, CheckerOptions::default());
        let mut state = SceneState::new(&scene);
        let mut counts = Counts::default();
        for (i, (q, &answer)) in q.chunks(self.robot.chain.dof()).zip(&answers.states).enumerate() {
            state.set_q(&scene, ROBOT, q).unwrap();
            let contact = exact.collides(&state);
            assert!(i % 8 != 0 || checker.state(q).unwrap() == answer, "alone and among others");
            match answer {
                Validity::Free => assert!(contact.is_none(), "proven free, but {contact:?} at {q:?}"),
                Validity::Hit => assert!(contact.is_some(), "proven hit, but free at {q:?}"),
                Validity::Uncertain => counts.uncertain_free += usize::from(contact.is_none()),
            }
            counts.free += usize::from(answer == Validity::Free);
            counts.hit += usize::from(answer == Validity::Hit);
            counts.uncertain += usize::from(answer == Validity::Uncertain);
        }
        for ((from, to), &proven) in ends.iter().zip(&answers.edges) {
            state.set_q(&scene, ROBOT, from).unwrap();
            let moves = [SweepMove::Robot { robot: ROBOT, to }];
            let hit = exact.sweep(&state, &moves, &SweepOptions::default()).unwrap();
            assert!(!proven || hit.is_none_or(|h| !h.certain), "proven free, but {hit:?} from {from:?} to {to:?}");
            counts.edges += 1;
            counts.proven_edges += usize::from(proven);
            counts.free_edges += usize::from(hit.is_none());
        }
        counts
    }
}

/// Instruction sets other than the best, and which share of the answers is compared on each: one in so many.
fn other_simd_levels() -> Vec<(SimdLevel, usize)> {
    let best = SimdLevel::new();
    let mut levels = Vec::new();
    #[cfg(target_arch = "x86_64")]
    {
        levels.extend(best.as_avx2().map(|avx2| (SimdLevel::Avx2(avx2), 4)));
        levels.extend(best.as_sse4_2().map(|sse| (SimdLevel::Sse4_2(sse), IN_SOFTWARE)));
    }
    let _ = best;
    levels
}

#[test]
fn random_robots_among_random_obstacles() {
    let mut random = Random(5);
    let mut all = Counts::default();
    for round in 0..12 {
        let joints = 2 + random.below(6);
        let robot = random.robot(joints);
        let base = random.pose(0.5);
        let count = [3, 12, 60][round % 3];
        let surroundings = Surroundings::new(&mut random, Kind::Mixed, count, 1.2);
        let covered = CoveredRobot::new(&robot, base).unwrap();
        let comparison = Comparison { robot: &robot, base, covered: &covered, surroundings: &surroundings };
        all.add(&comparison.run(&mut random, 400, 50).0);
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

/// The robots to compare: a few, or all of the data.
fn robots(data: &std::path::Path) -> Vec<std::path::PathBuf> {
    let few = ["panda", "ur5e", "kuka_kr150_2", "staubli_tx60"];
    let is_wanted = |path: &std::path::PathBuf| {
        states_wanted().is_some() || few.iter().any(|name| path.ends_with(format!("{name}.urdf")))
    };
    common::robots(data).into_iter().filter(is_wanted).collect()
}

#[test]
fn real_robots_among_random_obstacles() {
    let Some(data) = common::data() else { return };
    let mut random = Random(11);
    let paths = robots(&data);
    let states = ROUND[usize::from(states_wanted().is_some())];
    let per_robot = states_wanted().map_or(1500, |n| n.div_ceil(paths.len()));
    let folder = std::env::var_os("ELBOWROOM_VALIDITY_JOBS").map(std::path::PathBuf::from);
    let mut all = Counts::default();
    for path in paths {
        let srdf = Some(path.with_extension("srdf")).filter(|p| p.is_file());
        let options = elbowroom_formats::robot::LoadOptions { srdf, ..Default::default() };
        let robot = elbowroom_formats::robot::load(&path, &options).unwrap().robot;
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
        let mut of_robot = [Counts::default(); 3];
        let (mut job, mut ours) = (String::new(), String::new());
        // New surroundings every round.
        for round in 0..per_robot.div_ceil(states) {
            let (number, kind) = [(0, Kind::Primitives), (1, Kind::Meshes), (2, Kind::Cloud)][round % 3];
            let count = if kind == Kind::Cloud { 400 } else { 14 };
            let surroundings = Surroundings::new(&mut random, kind, count, 1.5);
            let comparison =
                Comparison { robot: &robot, base: Pose::IDENTITY, covered: &covered, surroundings: &surroundings };
            let (counts, q, answers) = comparison.run(&mut random, states, states / 10);
            of_robot[number].add(&counts);
            if folder.is_none() {
                continue;
            }
            if job.is_empty() {
                coal_job::robot(&mut job, &robot);
            }
            coal_job::surroundings(&mut job, &robot, &surroundings.as_solids(), &q);
            ours.extend(answers.states.iter().map(|answer| format!("{answer:?}\n").to_lowercase()));
        }
        for (kind, counts) in ["primitives", "meshes", "cloud"].iter().zip(&of_robot) {
            println!("{name}, {kind}: {counts:?}");
            all.add(counts);
        }
        if let Some(folder) = &folder {
            let file = |ending: &str| folder.join(format!("{name}.{ending}"));
            std::fs::write(file("job"), job).unwrap();
            std::fs::write(file("answers"), ours).unwrap();
        }
    }
    let mut line = String::new();
    let share = |part: usize, of: usize| 100.0 * part as f64 / of.max(1) as f64;
    let states = all.free + all.hit + all.uncertain;
    write!(line, "{states} configurations, {:.1} % not certain; ", share(all.uncertain, states)).unwrap();
    write!(line, "{} edges, {:.1} % of the free ones proven", all.edges, share(all.proven_edges, all.free_edges))
        .unwrap();
    println!("{line}; {all:?}");
}
