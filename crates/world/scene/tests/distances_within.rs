//! Comparison of the distances within a margin with single measurements of each pair.

use crate::common;
use crate::common::{Random, RandomGeometry, all_distances, link, random_state, scene_of};

use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, Level, PairDistance, Scene, SceneState, Selection};
use elbowroom_spatial::Pose;

/// Tolerance (m) between the distances of two methods.
const TOLERANCE: f64 = 1e-9;

fn near(checker: &mut Checker, state: &SceneState, margin: f64) -> Vec<PairDistance> {
    let mut found = Vec::new();
    checker.distances_within(state, margin, |d| found.push(d));
    found
}

#[test]
fn every_pair_within_the_margin_is_reported_as_measured_alone() {
    let padded = |m: GeometryId| if m == link(0, 3) { 0.03 } else { 0.0 };
    let scene = scene_of(21, |b| _ = b.padding(link(0, 3), 0.03));
    let mut r = Random(21);
    let all = [(Level::L1, true), (Level::L2, true), (Level::L3, true), (Level::L1, false)];
    let options =
        all.map(|(start, weights)| CheckerOptions { start, weights, matrix: weights, ..CheckerOptions::default() });
    let mut checkers = options.map(|o| Checker::new(&scene, o));
    let mut alone = Checker::new(&scene, CheckerOptions::default());
    let (mut reported, mut touching, mut left_out) = (0, 0, 0);
    for _ in 0..150 {
        let state = random_state(&scene, &mut r);
        let margin = r.between(0.0, 0.4);
        let truth = all_distances(&scene, &state, padded);
        for checker in &mut checkers {
            let found = near(checker, &state, margin);
            for (a, b, metres) in &truth {
                let of: Vec<_> = found.iter().filter(|d| (d.a, d.b) == (*a, *b)).collect();
                if (metres - margin).abs() > TOLERANCE {
                    assert_eq!(of.len(), usize::from(*metres < margin), "{a:?} {b:?} {metres} {margin}");
                }
                left_out += usize::from(of.is_empty());
                let Some(d) = of.first() else { continue };
                assert!(
                    (d.metres - metres).abs() < TOLERANCE && d.lower_bound <= d.metres && d.level == Level::L3,
                    "{d:?}"
                );
                assert!(
                    d.metres - d.lower_bound < TOLERANCE && (d.metres == 0.0) == (*metres == 0.0),
                    "{d:?} {metres}"
                );
                let exact = alone.between((*a).into(), (*b).into()).distance(&state).unwrap();
                assert!((exact.metres - d.metres).abs() < TOLERANCE);
                if d.metres > 0.0 {
                    assert!((d.on_a.distance(d.on_b) - padded(*a) - padded(*b) - d.metres).abs() < TOLERANCE, "{d:?}");
                }
                (reported, touching) = (reported + 1, touching + usize::from(d.metres == 0.0));
            }
            assert_eq!(found.is_empty(), checker.within(&state, margin).is_none());
        }
    }
    assert!(reported > 3000 && touching > 100 && left_out > 3000, "{reported} {touching} {left_out}");
}

#[test]
fn the_order_is_that_of_the_hierarchy_and_of_contacts() {
    let scene = scene_of(22, |_| {});
    let mut r = Random(22);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut several = 0;
    for _ in 0..400 {
        let state = random_state(&scene, &mut r);
        let found = near(&mut checker, &state, 0.3);
        let depth = |m: GeometryId| if let GeometryId::Link { link, .. } = m { link.0 } else { usize::MAX };
        assert!(found.windows(2).all(|w| depth(w[0].a).min(depth(w[0].b)) <= depth(w[1].a).min(depth(w[1].b))));
        let mut contacts = Vec::new();
        checker.contacts(&state, |c| contacts.push((c.a, c.b)));
        let of: Vec<_> = found.iter().filter(|d| d.metres == 0.0).map(|d| (d.a, d.b)).collect();
        assert_eq!(of, contacts);
        several += usize::from(contacts.len() > 1);
        let objects: Vec<_> =
            found.iter().filter(|d| matches!((d.a, d.b), (_, GeometryId::Object(_)))).copied().collect();
        let mut between = Vec::new();
        checker.between(Selection::Robots, Selection::Objects).distances_within(&state, 0.3, |d| between.push(d));
        assert_eq!(between.len(), objects.len());
        let same = |(x, y): (&PairDistance, &PairDistance)| {
            (x.a, x.b) == (y.a, y.b) && (x.metres - y.metres).abs() < TOLERANCE
        };
        assert!(between.iter().zip(&objects).all(same));
    }
    assert!(several > 20, "{several}");
}

#[test]
fn enclosing_volumes_report_no_fewer_pairs_and_no_larger_distances() {
    let scene = scene_of(23, |_| {});
    let mut r = Random(23);
    let mut exact = Checker::new(&scene, CheckerOptions::default());
    let levels = [Level::L1, Level::L2, Level::boxes(2), Level::Capsule, Level::Hull];
    let mut coarse = levels.map(|level| Checker::new(&scene, CheckerOptions { level, ..CheckerOptions::default() }));
    let mut more = 0;
    for _ in 0..100 {
        let state = random_state(&scene, &mut r);
        let truth = near(&mut exact, &state, 0.15);
        for checker in &mut coarse {
            let found = near(checker, &state, 0.15);
            for d in &truth {
                let of = found.iter().find(|f| (f.a, f.b) == (d.a, d.b)).expect("on the safe side");
                assert!(of.metres <= d.metres + 1e-12, "{of:?} {d:?}");
            }
            more += found.len() - truth.len();
        }
    }
    assert!(more > 100, "{more}");
}

#[test]
fn answers_are_invariant_under_rigid_transforms() {
    let mut r = Random(24);
    let away = r.pose(2.0);
    let build = |by: Pose| {
        let mut r = Random(25);
        let mut builder = Scene::builder();
        builder.robot("meshes", common::mesh_arm(), by);
        builder.robot(
            "mixed",
            common::mixed_arm(&mut r),
            by * Pose::from_translation(elbowroom_spatial::Vec3::X * 0.75),
        );
        builder.build().unwrap()
    };
    let (here, there) = (build(Pose::IDENTITY), build(away));
    let (mut one, mut other) =
        (Checker::new(&here, CheckerOptions::default()), Checker::new(&there, CheckerOptions::default()));
    let mut reported = 0;
    for _ in 0..100 {
        let (p, q) = (r.q(), r.q());
        let state = |scene: &Scene| {
            let mut state = SceneState::new(scene);
            state.set_q(scene, RobotId(0), &p).unwrap();
            state.set_q(scene, RobotId(1), &q).unwrap();
            state
        };
        let margin = 0.25;
        let (x, y) = (near(&mut one, &state(&here), margin), near(&mut other, &state(&there), margin));
        assert_eq!(x.len(), y.len());
        for (d, e) in x.iter().zip(&y) {
            assert!((d.a, d.b) == (e.a, e.b) && (d.metres - e.metres).abs() < TOLERANCE, "{d:?} {e:?}");
            reported += 1;
        }
    }
    assert!(reported > 300, "{reported}");
}

#[test]
fn nan_and_unbounded_geometry_are_near() {
    let scene = scene_of(26, |_| {});
    let mut checker = Checker::new(&scene, CheckerOptions { matrix: false, ..CheckerOptions::default() });
    let state = SceneState::new(&scene);
    let everything = near(&mut checker, &state, f64::INFINITY).len();
    assert_eq!(near(&mut checker, &state, f64::NAN).len(), everything);
    assert_eq!(everything, checker.between(Selection::All, Selection::All).len(&state));
    let touching = near(&mut checker, &state, 0.0);
    assert_eq!(near(&mut checker, &state, -1.0), touching);
    // In a state with an angle beyond all precision, everything that the angle moves is near, and nothing panics.
    let mut lost = SceneState::new(&scene);
    lost.set_q(&scene, RobotId(0), &[1e300, -1e300, 1e18]).unwrap();
    near(&mut checker, &lost, 0.1);
}
