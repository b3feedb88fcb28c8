//! Comparison of answers with the exact scene: proven free never collides, proven hit always does.
//!
//! `ELBOWROOM_VALIDITY_STATES=1000000` compares this number of configurations, and a tenth as many edges, over all robots
//! of the data. Use the release profile: `cargo test --release -p elbowroom-validity --test main
//! against_scene::real_robots -- --nocapture`. With `ELBOWROOM_VALIDITY_JOBS=DIRECTORY` it writes configurations and
//! answers for Coal, see `xtask/planning/README.md`.
//!
//! The exact scene checks the answers of the covers: whether a configuration that is proven free or hit collides, and
//! whether any of some configurations of an edge that is proven free collides. Some of the edges, proven or not, are also
//! swept.

#![allow(clippy::print_stdout, reason = "a comparison prints what it finds")]

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::common::{Kind, ROBOT, Random, RandomGeometry, Surroundings, coal_job, scene};
use elbowroom_kinematics::LinkId;
use elbowroom_robot::{GeometryId, Robot};
use elbowroom_scene::{Checker, CheckerOptions, Scene, SceneState, SweepMove, SweepOptions};
use elbowroom_spatial::Pose;
use elbowroom_testkit::extent::{amount, is_long_run};
use elbowroom_testkit::folder;
use elbowroom_validity::{CoveredRobot, Validity, ValidityChecker};
use fearless_simd::Level as SimdLevel;

/// Extent and density of a comparison.
#[derive(Debug, Clone, Copy)]
struct Extent {
    /// Number of configurations for each surroundings.
    states: usize,
    /// The exact scene sweeps one edge in this number.
    swept: usize,
    /// Number of configurations of a proven edge, in addition to its start, that the exact scene checks.
    points: usize,
    /// Number of configurations in which overlapping links are counted. Links that nearly always overlap form no
    /// collision pair.
    samples: usize,
    /// Largest number of surroundings drawn until a robot has configurations that are not proven to collide.
    draws: usize,
}

/// Extent for every build.
const SHORT: Extent = Extent { states: 200, swept: 3, points: 4, samples: 0, draws: 1 };
/// Extent for `ELBOWROOM_VALIDITY_STATES`.
const LONG: Extent = Extent { states: 5000, swept: 20, points: 12, samples: 60, draws: 11 };
/// Number of robots that are compared at the same time in a long run.
const THREADS: usize = 2;
/// One configuration and one edge in this number are compared on instruction sets without fused sums, which are slow
/// there.
const IN_SOFTWARE: usize = 200;
/// Fraction of a robot's configurations. Links that overlap in at least this fraction form no collision pair.
const NEARLY_ALWAYS: f64 = 0.95;

#[derive(Default, Debug, Clone, Copy)]
struct Counts {
    free: usize,
    hit: usize,
    uncertain: usize,
    edges: usize,
    proven_edges: usize,
    swept: usize,
    swept_proven: usize,
    swept_free: usize,
    /// Number of configurations and edges for which the exact scene contradicts the proof.
    contradictions: usize,
}

impl Counts {
    fn states(&self) -> usize {
        self.free + self.hit + self.uncertain
    }

    fn add(&mut self, other: &Self) {
        self.free += other.free;
        self.hit += other.hit;
        self.uncertain += other.uncertain;
        self.edges += other.edges;
        self.proven_edges += other.proven_edges;
        self.swept += other.swept;
        self.swept_proven += other.swept_proven;
        self.swept_free += other.swept_free;
        self.contradictions += other.contradictions;
    }

    fn add_answer(&mut self, answer: Validity) {
        match answer {
            Validity::Free => self.free += 1,
            Validity::Hit => self.hit += 1,
            Validity::Uncertain => self.uncertain += 1,
        }
    }

    fn contradicted(&mut self, what: std::fmt::Arguments) {
        println!("contradiction: {what}");
        self.contradictions += 1;
    }

    /// A row of a table, with fractions of all configurations, of all edges, and of the swept edges that are free.
    fn row(&self, name: &str) -> String {
        let share = |part: usize, of: usize| format!("{:.1} %", 100.0 * part as f64 / of.max(1) as f64);
        let of_states = |part: usize| share(part, self.states());
        format!(
            "| {name} | {} | {} | {} | {} | {} | {} | {} | {} |",
            self.states(),
            of_states(self.free),
            of_states(self.hit),
            of_states(self.uncertain),
            self.edges,
            share(self.proven_edges, self.edges),
            share(self.swept_proven, self.swept_free),
            self.contradictions,
        )
    }
}

/// A robot and its surroundings.
struct Comparison<'c> {
    robot: &'c Robot,
    base: Pose,
    covered: &'c CoveredRobot,
    surroundings: &'c Surroundings,
    extent: Extent,
}

/// Answers of a checker, for configurations and for edges.
#[derive(Debug, PartialEq)]
struct Answers {
    states: Vec<Validity>,
    edges: Vec<bool>,
}

/// An edge from a free configuration to an arbitrary one.
type Edge<'q> = (&'q [f64], Vec<f64>);

impl Comparison<'_> {
    /// Compares random configurations and edges with the exact scene, and instruction sets with each other.
    fn run(&self, random: &mut Random, states: usize, edges: usize) -> (Counts, Vec<f64>, Answers) {
        let set = self.surroundings.obstacle_set();
        let mut checker = ValidityChecker::new(self.covered, set);
        let chain = &self.robot.chain;
        let q: Vec<f64> = (0..states).flat_map(|_| random.q(chain)).collect();
        let mut answers = Answers { states: Vec::new(), edges: Vec::new() };
        checker.states(&q, &mut answers.states).unwrap();
        let free = q.chunks(chain.dof()).zip(&answers.states).filter(|(_, a)| **a == Validity::Free).map(|(q, _)| q);
        let starts: Vec<&[f64]> = free.collect();
        let ends: Vec<Edge> = starts
            .iter()
            .cycle()
            .take(if starts.is_empty() { 0 } else { edges })
            .map(|&from| {
                let (other, share) = (random.q(chain), random.unit().powi(2));
                (from, at(from, &other, share))
            })
            .collect();
        answers.edges = ends.iter().map(|(from, to)| checker.edge_is_free(from, to).unwrap()).collect();
        for (level, share) in other_simd_levels() {
            let mut checker = checker.clone().with_simd_level(level);
            let (n, m) = (states / share, ends.len() / share);
            let mut others = Vec::new();
            checker.states(&q[..n * chain.dof()], &mut others).unwrap();
            assert_eq!(others, answers.states[..n], "{level:?}");
            let others = ends[..m].iter().map(|(from, to)| checker.edge_is_free(from, to).unwrap());
            assert_eq!(others.collect::<Vec<_>>(), answers.edges[..m], "{level:?}");
        }
        for (q, &answer) in q.chunks(chain.dof()).zip(&answers.states).step_by(8) {
            assert_eq!(checker.state(q).unwrap(), answer, "alone and among others");
        }
        let scene = scene(self.robot, self.base, &self.surroundings.as_solids());
        let mut counts = Counts::default();
        self.compare_states(&scene, &q, &answers.states, &mut counts);
        self.compare_edges(&scene, random, &ends, &answers.edges, &mut counts);
        (counts, q, answers)
    }

    /// Compares configurations with the exact scene. Uncertain ones need no exact answer.
    fn compare_states(&self, scene: &Scene, q: &[f64], answers: &[Validity], counts: &mut Counts) {
        let mut exact = Checker::new(scene, CheckerOptions::default());
        let mut state = SceneState::new(scene);
        for (q, &answer) in q.chunks(self.robot.chain.dof()).zip(answers) {
            counts.add_answer(answer);
            if answer == Validity::Uncertain {
                continue;
            }
            state.set_q(scene, ROBOT, q).unwrap();
            let contact = exact.collides(&state);
            if (answer == Validity::Hit) != contact.is_some() {
                counts.contradicted(format_args!("{answer:?}, but {contact:?} at {q:?}"));
            }
        }
    }

    fn compare_edges(&self, scene: &Scene, random: &mut Random, ends: &[Edge], proven: &[bool], counts: &mut Counts) {
        let mut exact = Checker::new(scene, CheckerOptions::default());
        let mut state = SceneState::new(scene);
        let points = self.extent.points;
        for (i, ((from, to), &proven)) in ends.iter().zip(proven).enumerate() {
            counts.edges += 1;
            counts.proven_edges += usize::from(proven);
            for point in (0..points).filter(|_| proven) {
                // One point in each of `points` parts, the last one at the end.
                let share = if point + 1 == points { 1.0 } else { (point as f64 + random.unit()) / points as f64 };
                state.set_q(scene, ROBOT, &at(from, to, share)).unwrap();
                if let Some(contact) = exact.collides(&state) {
                    counts.contradicted(format_args!("free, but {contact:?} at {share} from {from:?} to {to:?}"));
                }
            }
            if i % self.extent.swept == 0 {
                state.set_q(scene, ROBOT, from).unwrap();
                let moves = [SweepMove::Robot { robot: ROBOT, to }];
                let hit = exact.sweep(&state, &moves, &SweepOptions::default()).unwrap();
                if proven && hit.is_some_and(|h| h.certain) {
                    counts.contradicted(format_args!("free, but {hit:?} from {from:?} to {to:?}"));
                }
                counts.swept += 1;
                counts.swept_proven += usize::from(proven);
                counts.swept_free += usize::from(hit.is_none());
            }
        }
    }
}

/// The configuration at a fraction of the way between two configurations.
fn at(from: &[f64], to: &[f64], share: f64) -> Vec<f64> {
    from.iter().zip(to).map(|(a, b)| a + share * (b - a)).collect()
}

/// Instruction sets other than the best, each with N: one answer in N is compared on it.
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
    // All robots share the obstacles: covering these takes longer than the rest of the test.
    let surroundings = [3, 10, 30].map(|count| Surroundings::new(&mut random, Kind::Mixed, count, 1.2));
    let rounds = amount(6, 12);
    for round in 0..rounds {
        let joints = 2 + random.index(6);
        let robot = random.robot(joints);
        let base = random.pose(0.5);
        let covered = CoveredRobot::new(&robot, base).unwrap();
        let comparison = Comparison {
            robot: &robot,
            base,
            covered: &covered,
            surroundings: &surroundings[round % 3],
            extent: Extent { swept: 1, ..SHORT },
        };
        all.add(&comparison.run(&mut random, 400, 50).0);
    }
    println!("{all:?}");
    assert_eq!(all.contradictions, 0);
    assert!(all.free > 42 * rounds && all.hit > 42 * rounds, "{all:?}");
    // The covers decide most cases.
    assert!(all.uncertain * 4 < all.free + all.hit, "{all:?}");
    assert!(all.swept_proven * 10 > all.swept_free * 7, "{all:?}");
}

/// Total number of configurations on real robots, if it is set.
fn states_wanted() -> Option<usize> {
    std::env::var("ELBOWROOM_VALIDITY_STATES").ok().map(|n| n.parse().expect("ELBOWROOM_VALIDITY_STATES is a number"))
}

/// The robots to compare: a few, or all robots of the data.
fn robots() -> Vec<PathBuf> {
    let few = if is_long_run() {
        &["panda", "ur5e", "kuka_kr150_2", "staubli_tx60"][..]
    } else {
        &["panda", "ur5e", "kuka_kr150_2"]
    };
    let is_wanted =
        |path: &PathBuf| states_wanted().is_some() || few.iter().any(|name| path.ends_with(format!("{name}.urdf")));
    folder::robots(&["urdf"]).into_iter().filter(is_wanted).collect()
}

fn load(path: &Path) -> Robot {
    let srdf = Some(path.with_extension("srdf")).filter(|p| p.is_file());
    let options = elbowroom_formats::robot::LoadOptions { srdf, ..Default::default() };
    elbowroom_formats::robot::load(path, &options).unwrap().robot
}

/// Disables the pairs of links that nearly always overlap: with them, nearly every configuration would collide.
fn disable_overlapping(robot: &mut Robot, random: &mut Random, samples: usize) {
    if samples == 0 {
        return;
    }
    let scene = scene(robot, Pose::IDENTITY, &[]);
    let mut exact = Checker::new(&scene, CheckerOptions::default());
    let mut state = SceneState::new(&scene);
    let mut overlaps = std::collections::BTreeMap::<(LinkId, LinkId), usize>::new();
    for _ in 0..samples {
        state.set_q(&scene, ROBOT, &random.q(&robot.chain)).unwrap();
        exact.contacts(&state, |contact| {
            if let (GeometryId::Link { link: a, .. }, GeometryId::Link { link: b, .. }) = (contact.a, contact.b) {
                *overlaps.entry((a, b)).or_default() += 1;
            }
        });
    }
    let often = overlaps.into_iter().filter(|(_, count)| *count as f64 >= NEARLY_ALWAYS * samples as f64);
    robot.disabled_pairs.extend(often.map(|((a, b), _)| (a, b, "Default".to_owned())));
}

/// Approximate upper bound on the distance of any point of the robot from its base, m.
fn reach_m(robot: &Robot) -> f64 {
    let extent = |link: LinkId| {
        let boxes = robot.colliders[link.0].iter().map(|c| c.shape.aabb(&c.in_link));
        boxes.reduce(|a, b| a.union(&b)).map_or(0.0, |b| 0.5 * b.extent().length())
    };
    let joints: f64 = robot.chain.joints().iter().map(|j| j.origin.translation.length()).sum();
    joints + robot.links_with_colliders().map(extent).fold(0.0, f64::max)
}

/// Surroundings among which a robot has configurations that are not proven to collide, if the search finds them soon.
fn surroundings(robot: &Robot, covered: &CoveredRobot, random: &mut Random, kind: Kind, draws: usize) -> Surroundings {
    // Covering a mesh takes as long as hundreds of configurations.
    let solids = if states_wanted().is_some() || is_long_run() { 14 } else { 6 };
    let count = if kind == Kind::Cloud { 400 } else { solids };
    let mut draw = || Surroundings::new(random, kind, count, (0.5 * reach_m(robot)).max(1.0));
    let mut drawn = draw();
    for i in 1..draws {
        if is_open(robot, covered, &drawn, &mut Random(i as u64)) {
            break;
        }
        drawn = draw();
    }
    drawn
}

/// True if more than two of twenty configurations are not proven to collide.
fn is_open(robot: &Robot, covered: &CoveredRobot, among: &Surroundings, random: &mut Random) -> bool {
    let mut checker = ValidityChecker::new(covered, among.obstacle_set());
    let mut is_hit = || checker.state(&random.q(&robot.chain)).unwrap() == Validity::Hit;
    (0..20).filter(|_| !is_hit()).count() > 2
}

/// Compares one robot among surroundings of three kinds, new ones every round.
fn compare(path: &Path, random: &mut Random, (states, extent): (usize, Extent)) -> Counts {
    let mut robot = load(path);
    disable_overlapping(&mut robot, random, extent.samples);
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let covered = CoveredRobot::new(&robot, Pose::IDENTITY).unwrap();
    let folder = std::env::var_os("ELBOWROOM_VALIDITY_JOBS").map(PathBuf::from);
    let mut all = Counts::default();
    let (mut job, mut ours) = (String::new(), String::new());
    coal_job::robot(&mut job, &robot);
    let rounds = states.div_ceil(extent.states).next_multiple_of(3);
    for round in 0..rounds {
        let kind = [Kind::Primitives, Kind::Meshes, Kind::Cloud][round % 3];
        let among = surroundings(&robot, &covered, random, kind, extent.draws);
        let comparison =
            Comparison { robot: &robot, base: Pose::IDENTITY, covered: &covered, surroundings: &among, extent };
        let states = states.div_ceil(rounds);
        let (counts, q, answers) = comparison.run(random, states, states.div_ceil(10));
        all.add(&counts);
        if folder.is_some() {
            coal_job::surroundings(&mut job, &robot, &among.as_solids(), &q);
            ours.extend(answers.states.iter().map(|answer| format!("{answer:?}\n").to_lowercase()));
        }
    }
    if let Some(folder) = &folder {
        std::fs::write(folder.join(format!("{name}.job")), job).unwrap();
        std::fs::write(folder.join(format!("{name}.answers")), ours).unwrap();
    }
    println!("{}", all.row(&name));
    all
}

#[test]
fn real_robots_among_random_obstacles() {
    let paths = robots();
    let extent = if states_wanted().is_some() { LONG } else { SHORT };
    let short = amount(600, 1500);
    let per_robot = states_wanted().map_or(short, |n| n.div_ceil(paths.len().max(1)));
    println!("| robot | states | free | hit | not certain | edges | proven free | of the free | contradictions |");
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let next = AtomicUsize::new(0);
    let work = || {
        let mut all = Counts::default();
        loop {
            let i = next.fetch_add(1, Ordering::Relaxed);
            let Some(path) = paths.get(i) else { return all };
            all.add(&compare(path, &mut Random(11 + i as u64), (per_robot, extent)));
        }
    };
    let mut all = Counts::default();
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..THREADS).map(|_| scope.spawn(work)).collect();
        for thread in threads {
            all.add(&thread.join().unwrap());
        }
    });
    println!("{}", all.row("all"));
    println!("{all:?}");
    assert_eq!(all.contradictions, 0);
}
