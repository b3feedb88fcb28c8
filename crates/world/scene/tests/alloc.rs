//! Queries do not allocate after a checker is created.
//!
//! The test runs without the test harness, because its threads also allocate, and the counter counts the whole process.

mod common;

use common::{Random, RandomGeometry, scene_of};

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::ccd::ConstantTwist;
use elbowroom_robot::{ObjectId, RobotId};

use elbowroom_scene::{
    Checker, CheckerOptions, Level, LevelOfDetail, SceneMotion, SceneState, Selection, SweepMove, SweepOptions,
};
use elbowroom_spatial::Vec3;
use elbowroom_testkit::allocation::{AllocationCounter, COUNTING_ALLOCATOR, CountingAllocator};

#[global_allocator]
static ALLOCATOR: CountingAllocator = COUNTING_ALLOCATOR;

fn main() {
    let scene = scene_of(51, |_| {});
    let mut r = Random(51);
    let mut states = [SceneState::new(&scene), SceneState::new(&scene)];
    states[1].attach(&scene, ObjectId(5), RobotId(0), LinkId(3), &[]).unwrap();
    let motion = SceneMotion::new(&scene);
    for level in [Level::Auto, Level::L1, Level::L2, Level::boxes(4), Level::Capsule, Level::Hull, Level::L3] {
        for state in &mut states {
            let mut checker = Checker::new(&scene, CheckerOptions { level, ..CheckerOptions::default() });
            let (one, other) = (Selection::Robot(RobotId(0)), Selection::Robot(RobotId(1)));
            // The first query about a selection or an arrangement of attached objects builds its list.
            checker.collides(state);
            checker.between(one, other).collides(state);
            let counter = AllocationCounter::start();
            let mut found = 0;
            for _ in 0..200 {
                state.set_q(&scene, RobotId(0), &r.q()).unwrap();
                state.set_q(&scene, RobotId(1), &r.q()).unwrap();
                found += usize::from(checker.collides(state).is_some());
                found += usize::from(checker.within(state, 0.05).is_some());
                found += usize::from(checker.distance(state).is_some_and(|d| d.metres > 0.0));
                found += usize::from(checker.between(one, other).distance(state).is_some());
                checker.contacts(state, |_| found += 1);
                checker.distances_within(state, 0.2, |_| found += 1);
                checker.approaching(state, &motion, &LevelOfDetail::default(), 1.0, |_| found += 1);
                checker.between(one, other).distances_within(state, 0.2, |_| found += 1);
            }
            assert_eq!(counter.allocations(), 0, "{level}");
            assert!(found > 400);
        }
    }

    // Sweeps that are longer than all before allocate; repeating the same sweeps does not.
    let path = ConstantTwist::linear(scene.objects()[2].in_world, Vec3::X);
    for state in &mut states {
        let mut checker = Checker::new(&scene, CheckerOptions::default());
        let mut sweep_all = || {
            let mut r = Random(52);
            let mut hits = 0;
            for _ in 0..30 {
                state.set_q(&scene, RobotId(0), &r.q()).unwrap();
                let (p, q) = (r.q(), r.q());
                let moves =
                    [SweepMove::Robot { robot: RobotId(0), to: &p }, SweepMove::Robot { robot: RobotId(1), to: &q }];
                let mixed = [moves[0], SweepMove::Object { object: ObjectId(2), path: &path }];
                let options = SweepOptions::default();
                hits += usize::from(checker.sweep(state, &moves, &options).unwrap().is_some());
                hits += usize::from(checker.sweep(state, &mixed, &options).unwrap().is_some());
                hits += usize::from(checker.sweep_path(state, RobotId(1), &[p, q], &options).unwrap().is_some());
            }
            hits
        };
        let first = sweep_all();
        let counter = AllocationCounter::start();
        let second = sweep_all();
        let allocations = counter.allocations();
        assert!(first == second && first > 10);
        assert_eq!(allocations, 0);
    }
}
