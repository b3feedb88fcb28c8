//! Level of detail on our RX60B among meshes and boxes that move: the same answers with and without, and what is saved.
//! 100,000 motions with `ELBOWROOM_LONG=1`, `--release`, `-- --nocapture` for the table.

mod common;
#[path = "common/rx60b.rs"]
mod rx60b;

use std::time::{Duration, Instant};

use common::Random;
use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_scene::{
    Approach, Checker, Counts, Detail, LevelOfDetail, Object, Options, Scene, SceneMotion, SceneState, Selection,
};
use elbowroom_spatial::{Motion, Pose, Vec3};

fn count() -> usize {
    if std::env::var_os("ELBOWROOM_LONG").is_some() { 100_000 } else { 2_000 }
}

fn scene() -> Scene {
    let robot = rx60b::robot();
    let part = robot.bodies[3][0].shape.clone();
    let mut builder = Scene::builder();
    builder.robot("rx60b", robot, Pose::IDENTITY);
    for k in 0..6 {
        let cuboid = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.05, 0.1, 0.15) });
        let shape = if k % 2 == 0 { part.clone() } else { cuboid };
        builder.object(Object { name: format!("thing {k}"), shape, in_world: Pose::IDENTITY });
    }
    builder.build().unwrap()
}

/// One way of asking: what it was told, and what it took.
struct Way<'s> {
    checker: Checker<'s>,
    policy: LevelOfDetail,
    found: Vec<Approach>,
    spent: Duration,
}

impl<'s> Way<'s> {
    fn new(scene: &'s Scene, progressive: bool) -> Self {
        let policy = LevelOfDetail { progressive, exact_m: 0.05, exact_s: 0.1, within_m: 1.0 };
        Self { checker: Checker::new(scene, Options::default()), policy, found: Vec::new(), spent: Duration::ZERO }
    }

    fn ask(&mut self, state: &SceneState, motion: &SceneMotion) {
        self.found.clear();
        let started = Instant::now();
        let mut ask = self.checker.between(Selection::Robots, Selection::Objects);
        ask.approaching(state, motion, &self.policy, 1.0, |p| self.found.push(p));
        self.spent += started.elapsed();
    }

    fn row(&self, name: &str, motions: usize) -> String {
        let Counts { mesh_boxes, mesh_triangles, pairs_tested, .. } = self.checker.counts();
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
fn the_same_answers_with_and_without_detail_for_less_work() {
    let scene = scene();
    let mut r = Random(61);
    let (mut with, mut without) = (Way::new(&scene, true), Way::new(&scene, false));
    let (mut told, mut coarse, mut contacts, mut soon, mut times) = (0_u64, [0_u64; 3], 0_u64, 0_u64, 0_u64);
    let motions = count();
    for k in 0..motions {
        let mut state = SceneState::new(&scene);
        let mut motion = SceneMotion::new(&scene);
        for object in 0..scene.objects().len() {
            // Half of them anywhere, half where the arm works.
            let far = if object % 2 == k % 2 { 1.5 } else { 0.6 };
            let mut pose = r.pose(far);
            pose.translation.z += 0.4;
            state.place(&scene, object, pose).unwrap();
            let moving = Motion { velocity: r.vec3(0.5), angular_velocity: r.vec3(1.0), ..Motion::REST };
            motion.set_object(&scene, object, moving).unwrap();
        }
        let q: Vec<f64> = rx60b::limits().map(|(l, u)| r.between(l, u)).collect();
        state.set_q(&scene, 0, &q).unwrap();
        let qd: Vec<f64> = q.iter().map(|_| r.between(-1.0, 1.0)).collect();
        motion.set_qd(&scene, &state, 0, &qd).unwrap();
        with.ask(&state, &motion);
        without.ask(&state, &motion);
        let mut others = with.found.iter();
        for p in &without.found {
            assert_eq!(p.detail, Detail::Exact);
            told += 1;
            contacts += u64::from(p.metres == 0.0);
            // In the same order.
            let other =
                others.find(|o| (o.a, o.b) == (p.a, p.b)).expect("what is told exactly is told coarsely as well");
            if let Detail::Boxes(depth) = other.detail {
                coarse[usize::from(depth)] += 1;
                assert!(p.metres > 0.05 && other.lower_bound > 0.05 && other.lower_bound <= p.metres);
                assert!(other.earliest_s >= 0.1);
            } else {
                soon += 1;
                assert!((other.metres - p.metres).abs() < 1e-9 && (p.metres == 0.0) == (other.metres == 0.0));
                // Of several nearest points another may be told.
                let same = other.on_a.distance(p.on_a) + other.on_b.distance(p.on_b) < 1e-9 && p.metres > 1e-3;
                assert!(!same || (other.closing_m_s - p.closing_m_s).abs() < 1e-5, "{other:?} {p:?}");
                times += u64::from(same);
            }
        }
    }
    println!("{motions} motions, {told} pairs told, {contacts} in contact; by boxes: {coarse:?}, exactly: {soon}");
    println!("per motion   solids      box tests  triangle pairs      time");
    println!("{}\n{}", without.row("exact", motions), with.row("progressive", motions));
    let (a, b) = (with.checker.counts(), without.checker.counts());
    let saved = |a: u64, b: u64| 100.0 * (1.0 - a as f64 / b as f64);
    println!(
        "saved: {:.1} % of solids measured, {:.1} % of box tests, {:.1} % of triangle pairs, {:.1} % of the time",
        saved(a.pairs_tested.l3, b.pairs_tested.l3),
        saved(a.mesh_boxes, b.mesh_boxes),
        saved(a.mesh_triangles, b.mesh_triangles),
        100.0 * (1.0 - with.spent.as_secs_f64() / without.spent.as_secs_f64())
    );
    assert!(times > soon / 3, "{times} of {soon}");
    assert!(contacts > 100 && coarse.iter().sum::<u64>() > told / 3, "{contacts} {coarse:?} {told}");
    assert!(a.pairs_tested.l3 < b.pairs_tested.l3 && a.mesh_triangles < b.mesh_triangles);
}
