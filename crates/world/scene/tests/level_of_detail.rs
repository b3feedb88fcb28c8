//! Level of detail on the example RX60B among moving meshes and boxes: equal answers with and without it, and the
//! savings.
//!
//! `ELBOWROOM_LONG=1` tests 100,000 motions (use `--release`); `-- --nocapture` prints the table.

use crate::common::rx60b;
use std::time::{Duration, Instant};

use crate::common::{Random, RandomGeometry};
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_robot::{ObjectId, RobotId};

use elbowroom_scene::{
    ApproachingPair, Checker, CheckerOptions, CheckerStats, Detail, LevelOfDetail, Object, Scene, SceneMotion,
    SceneState, Selection,
};
use elbowroom_spatial::{FrameMotion, Pose, Vec3};

fn count() -> usize {
    elbowroom_testkit::extent::amount(2_000, 100_000)
}

fn scene() -> Scene {
    let robot = rx60b::robot();
    let part = robot.colliders[3][0].shape.clone();
    let mut builder = Scene::builder();
    builder.robot("rx60b", robot, Pose::IDENTITY);
    for k in 0..6 {
        let cuboid = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.05, 0.1, 0.15) });
        let shape = if k % 2 == 0 { part.clone() } else { cuboid };
        builder.object(Object { name: format!("thing {k}"), shape, in_world: Pose::IDENTITY });
    }
    builder.build().unwrap()
}

/// A checker with a policy, its answers and its time.
struct Candidate<'s> {
    checker: Checker<'s>,
    policy: LevelOfDetail,
    found: Vec<ApproachingPair>,
    spent: Duration,
}

impl<'s> Candidate<'s> {
    fn new(scene: &'s Scene, progressive: bool) -> Self {
        let policy = LevelOfDetail { progressive, exact_m: 0.05, exact_s: 0.1, within_m: 1.0 };
        Self {
            checker: Checker::new(scene, CheckerOptions::default()),
            policy,
            found: Vec::new(),
            spent: Duration::ZERO,
        }
    }

    fn query(&mut self, state: &SceneState, motion: &SceneMotion) {
        self.found.clear();
        let started = Instant::now();
        let mut query = self.checker.between(Selection::Robots, Selection::Objects);
        query.approaching(state, motion, &self.policy, 1.0, |p| self.found.push(p));
        self.spent += started.elapsed();
    }

    fn row(&self, name: &str, motions: usize) -> String {
        let CheckerStats { mesh_boxes, mesh_triangles, pairs_tested, .. } = self.checker.stats();
        let per = |n: u64| n as f64 / motions as f64;
        format!(
            "{name:<12} {:>9.1} {:>12.1} {:>14.1} {:>9.2} µs",
            per(pairs_tested.l3),
            per(mesh_boxes),
            per(mesh_triangles),
            self.spent.as_secs_f64() * 1e6 / motions as f64
        )
    }
}

#[test]
fn level_of_detail_gives_the_same_answers_for_less_work() {
    let scene = scene();
    let mut r = Random(61);
    let (mut with, mut without) = (Candidate::new(&scene, true), Candidate::new(&scene, false));
    let (mut reported, mut coarse, mut contacts, mut soon, mut times) = (0_u64, [0_u64; 3], 0_u64, 0_u64, 0_u64);
    let motions = count();
    for k in 0..motions {
        let mut state = SceneState::new(&scene);
        let mut motion = SceneMotion::new(&scene);
        for (object, id) in (0..scene.objects().len()).map(|o| (o, ObjectId(o))) {
            // Half of the poses are anywhere, half in the arm's workspace.
            let far = if object % 2 == k % 2 { 1.5 } else { 0.6 };
            let mut pose = r.pose(far);
            pose.translation.z += 0.4;
            state.place(&scene, id, pose).unwrap();
            let moving = FrameMotion { velocity: r.vec3(0.5), angular_velocity: r.vec3(1.0), ..FrameMotion::REST };
            motion.set_object(&scene, id, moving).unwrap();
        }
        let q: Vec<f64> = rx60b::limits().map(|(l, u)| r.between(l, u)).collect();
        state.set_q(&scene, RobotId(0), &q).unwrap();
        let qd: Vec<f64> = q.iter().map(|_| r.between(-1.0, 1.0)).collect();
        motion.set_qd(&scene, &state, RobotId(0), &qd).unwrap();
        with.query(&state, &motion);
        without.query(&state, &motion);
        let mut others = with.found.iter();
        for p in &without.found {
            assert_eq!(p.detail, Detail::Exact);
            reported += 1;
            contacts += u64::from(p.metres == 0.0);
            // Pairs are in the same order.
            let other = others
                .find(|o| (o.a, o.b) == (p.a, p.b))
                .expect("a pair reported exactly is reported coarsely as well");
            if let Detail::Boxes(depth) = other.detail {
                coarse[usize::from(depth)] += 1;
                assert!(p.metres > 0.05 && other.lower_bound > 0.05 && other.lower_bound <= p.metres);
                assert!(other.earliest_s >= 0.1);
            } else {
                soon += 1;
                assert!((other.metres - p.metres).abs() < 1e-9 && (p.metres == 0.0) == (other.metres == 0.0));
                // If a pair has several nearest points, another one may be reported.
                let same = other.on_a.distance(p.on_a) + other.on_b.distance(p.on_b) < 1e-9 && p.metres > 1e-3;
                assert!(!same || (other.closing_m_s - p.closing_m_s).abs() < 1e-5, "{other:?} {p:?}");
                times += u64::from(same);
            }
        }
    }
    println!(
        "{motions} motions, {reported} pairs reported, {contacts} in contact; by boxes: {coarse:?}, exactly: {soon}"
    );
    println!("per motion   shapes      box tests  triangle pairs      time");
    println!("{}\n{}", without.row("exact", motions), with.row("progressive", motions));
    let (a, b) = (with.checker.stats(), without.checker.stats());
    let saved = |a: u64, b: u64| 100.0 * (1.0 - a as f64 / b as f64);
    println!(
        "saved: {:.1} % of shapes measured, {:.1} % of box tests, {:.1} % of triangle pairs, {:.1} % of the time",
        saved(a.pairs_tested.l3, b.pairs_tested.l3),
        saved(a.mesh_boxes, b.mesh_boxes),
        saved(a.mesh_triangles, b.mesh_triangles),
        100.0 * (1.0 - with.spent.as_secs_f64() / without.spent.as_secs_f64())
    );
    assert!(times > soon / 3, "{times} of {soon}");
    assert!(contacts > 100 && coarse.iter().sum::<u64>() > reported / 3, "{contacts} {coarse:?} {reported}");
    assert!(a.pairs_tested.l3 < b.pairs_tested.l3 && a.mesh_triangles < b.mesh_triangles);
}
