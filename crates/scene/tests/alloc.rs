//! Questions take no memory once a checker is made. Without the test harness: its threads
//! take memory, too, and the counter counts the whole process.

mod common;

use std::alloc::System;

use common::{Random, scene_of};
use elbowroom_kinematics::LinkId;
use elbowroom_proximity::impact::Steady;
use elbowroom_scene::{Checker, Level, LevelOfDetail, Move, Options, SceneMotion, SceneState, Selection, SweepOptions};
use elbowroom_spatial::Vec3;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn main() {
    let scene = scene_of(51, |_| {});
    let mut r = Random(51);
    let mut states = [SceneState::new(&scene), SceneState::new(&scene)];
    states[1].attach(&scene, 5, 0, LinkId(3), &[]).unwrap();
    let motion = SceneMotion::new(&scene);
    for level in [Level::Auto, Level::L1, Level::L2, Level::Capsule, Level::Hull, Level::L3] {
        for state in &mut states {
            let mut checker = Checker::new(&scene, Options { level, ..Options::default() });
            let (one, other) = (Selection::Robot(0), Selection::Robot(1));
            // The first question about a selection or an arrangement makes its list.
            checker.collides(state);
            checker.between(one, other).collides(state);
            let region = Region::new(ALLOCATOR);
            let mut found = 0;
            for _ in 0..200 {
                state.set_q(&scene, 0, &r.q()).unwrap();
                state.set_q(&scene, 1, &r.q()).unwrap();
                found += usize::from(checker.collides(state).is_some());
                found += usize::from(checker.within(state, 0.05).is_some());
                found += usize::from(checker.distance(state).is_some_and(|d| d.metres > 0.0));
                found += usize::from(checker.between(one, other).distance(state).is_some());
                checker.contacts(state, |_| found += 1);
                checker.near(state, 0.2, |_| found += 1);
                checker.approaching(state, &motion, &LevelOfDetail::default(), 1.0, |_| found += 1);
                checker.between(one, other).near(state, 0.2, |_| found += 1);
            }
            let used = region.change();
            assert_eq!((used.allocations, used.reallocations), (0, 0), "{level}");
            assert!(found > 400);
        }
    }

    // Sweeps take memory until none is longer than one before: the same ones again take none.
    let path = Steady::linear(scene.objects()[2].in_world, Vec3::X);
    for state in &mut states {
        let mut checker = Checker::new(&scene, Options::default());
        let mut sweep_all = || {
            let mut r = Random(52);
            let mut hits = 0;
            for _ in 0..30 {
                state.set_q(&scene, 0, &r.q()).unwrap();
                let (p, q) = (r.q(), r.q());
                let moves = [Move::Robot { robot: 0, to: &p }, Move::Robot { robot: 1, to: &q }];
                let mixed = [moves[0], Move::Object { object: 2, path: &path }];
                let options = SweepOptions::default();
                hits += usize::from(checker.sweep(state, &moves, &options).unwrap().is_some());
                hits += usize::from(checker.sweep(state, &mixed, &options).unwrap().is_some());
                hits += usize::from(checker.sweep_path(state, 1, &[p, q], &options).unwrap().is_some());
            }
            hits
        };
        let first = sweep_all();
        let region = Region::new(ALLOCATOR);
        let second = sweep_all();
        let used = region.change();
        assert!(first == second && first > 10);
        assert_eq!((used.allocations, used.reallocations), (0, 0));
    }
}
