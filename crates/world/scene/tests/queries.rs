//! Comparison of every query with a direct test of all pairs.

use crate::common::{Random, RandomGeometry, all_distances, apart, link, random_state, scene_of};

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::{HalfSpace, Shape, Sphere};
use elbowroom_robot::{Collider, GeometryId, ObjectId, RobotId};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use elbowroom_scene::{Checker, CheckerOptions, Level, Object, Scene, SceneState, Selection};

fn options() -> Vec<CheckerOptions> {
    let mut all = Vec::new();
    for start in [Level::L1, Level::L2, Level::L3] {
        for (weights, matrix) in [(true, true), (false, false), (true, false), (false, true)] {
            all.push(CheckerOptions { level: Level::Auto, start, weights, matrix });
        }
    }
    all.push(CheckerOptions { level: Level::L3, ..CheckerOptions::default() });
    all
}

const SELECTIONS: [(Selection, Selection); 9] = [
    (Selection::All, Selection::All),
    (Selection::Robot(RobotId(0)), Selection::Robot(RobotId(1))),
    (Selection::Robot(RobotId(1)), Selection::Robot(RobotId(1))),
    (Selection::Robots, Selection::Robots),
    (Selection::Robot(RobotId(0)), Selection::Objects),
    (Selection::Robot(RobotId(1)), Selection::Object(ObjectId(6))),
    (Selection::Link { robot: RobotId(0), link: LinkId(3) }, Selection::Link { robot: RobotId(1), link: LinkId(2) }),
    (Selection::Object(ObjectId(5)), Selection::Link { robot: RobotId(1), link: LinkId(3) }),
    (Selection::Link { robot: RobotId(1), link: LinkId(3) }, Selection::All),
];

fn contains(s: Selection, m: GeometryId) -> bool {
    match (s, m) {
        (Selection::All, _)
        | (Selection::Robots, GeometryId::Link { .. })
        | (Selection::Objects, GeometryId::Object(_)) => true,
        (Selection::Robot(r), GeometryId::Link { robot, .. }) => r == robot,
        (Selection::Link { .. } | Selection::Object(_), _) => s == m.into(),
        _ => false,
    }
}

/// Distance (m) from a threshold within which two methods may give different yes-or-no answers.
const DOUBT: f64 = 1e-9;

#[test]
fn all_queries_levels_and_options_agree_with_all_pairs_tested_directly() {
    let padded = |m: GeometryId| {
        if m == link(0, 3) {
            0.02
        } else if m == GeometryId::Object(ObjectId(2)) {
            0.05
        } else {
            0.0
        }
    };
    let scene = scene_of(5, |b| {
        b.padding(link(0, 3), 0.02).padding(GeometryId::Object(ObjectId(2)), 0.05);
    });
    let mut checkers: Vec<_> = options().into_iter().map(|o| Checker::new(&scene, o)).collect();
    let mut r = Random(11);
    let (mut free, mut touching) = (0, 0);
    for _ in 0..120 {
        let state = random_state(&scene, &mut r);
        let truth = all_distances(&scene, &state, padded);
        let tolerance = r.between(0.0, 0.2);
        for (one, other) in SELECTIONS {
            let picked: Vec<_> = truth
                .iter()
                .filter(|(a, b, _)| {
                    (contains(one, *a) && contains(other, *b)) || (contains(one, *b) && contains(other, *a))
                })
                .collect();
            let nearest = picked.iter().map(|p| p.2).fold(f64::INFINITY, f64::min);
            let of = |a, b| picked.iter().find(|p| (p.0, p.1) == (a, b)).map(|p| p.2);
            for checker in &mut checkers {
                let context = format!("{one:?} {other:?} {:?}", checker.options());
                let mut ask = checker.between(one, other);
                let contact = ask.collides(&state);
                if !(1e-15..=DOUBT).contains(&nearest) {
                    assert_eq!(contact.is_some(), nearest == 0.0, "{context} {nearest}");
                }
                if let Some(c) = contact {
                    assert!(of(c.a, c.b).unwrap() < DOUBT && c.level == Level::L3, "{context}");
                }
                let close = ask.within(&state, tolerance);
                assert_eq!(close.is_some(), nearest <= tolerance, "{context} {nearest} {tolerance}");
                assert!(close.is_none_or(|c| of(c.a, c.b).unwrap() <= tolerance + DOUBT), "{context}");
                let d = ask.distance(&state).unwrap();
                assert!((d.metres - nearest).abs() < DOUBT, "{context} {d:?} {nearest}");
                assert!(d.lower_bound <= d.metres && d.metres - d.lower_bound < DOUBT, "{context} {d:?}");
                assert!((of(d.a, d.b).unwrap() - nearest).abs() < DOUBT, "{context} {d:?}");
                if d.metres > 0.0 {
                    let between = d.on_a.distance(d.on_b) - padded(d.a) - padded(d.b);
                    assert!((between - d.metres).abs() < DOUBT, "{context} {d:?}");
                }
                let mut found = Vec::new();
                ask.contacts(&state, |c| found.push((c.a, c.b)));
                found.sort();
                let mut touch: Vec<_> = picked.iter().filter(|p| p.2 == 0.0).map(|p| (p.0, p.1)).collect();
                touch.sort();
                assert_eq!(found, touch, "{context}");
            }
            if nearest > 0.0 { free += 1 } else { touching += 1 }
        }
    }
    assert!(free > 100 && touching > 60, "{free} free, {touching} touching");
}

#[test]
fn selections_are_symmetric() {
    let scene = scene_of(6, |_| {});
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut r = Random(3);
    for _ in 0..100 {
        let state = random_state(&scene, &mut r);
        for (one, other) in SELECTIONS {
            let d = checker.between(one, other).distance(&state).unwrap();
            let e = checker.between(other, one).distance(&state).unwrap();
            assert!((d.metres - e.metres).abs() < DOUBT);
            let (c, e) = (checker.between(one, other).collides(&state), checker.between(other, one).collides(&state));
            assert_eq!(c.is_some(), e.is_some());
        }
    }
}

#[test]
fn coarse_levels_are_conservative() {
    let scene = scene_of(7, |_| {});
    let mut exact = Checker::new(&scene, CheckerOptions::default());
    let mut r = Random(5);
    let mut looser = [0; 6];
    let levels = [Level::L1, Level::L2, Level::Capsule, Level::Hull, Level::boxes(1), Level::boxes(5)];
    let mut coarse = levels.map(|level| Checker::new(&scene, CheckerOptions { level, ..CheckerOptions::default() }));
    for _ in 0..300 {
        let state = random_state(&scene, &mut r);
        let tolerance = r.between(0.0, 0.1);
        for (one, other) in SELECTIONS {
            let truth = exact.between(one, other).distance(&state).unwrap();
            for (i, checker) in coarse.iter_mut().enumerate() {
                let d = checker.between(one, other).distance(&state).unwrap();
                assert!(d.metres <= truth.metres + 1e-12, "{:?} {d:?} {truth:?}", levels[i]);
                looser[i] += u32::from(d.metres < truth.metres - 1e-6);
                assert!(truth.metres > 0.0 || checker.between(one, other).collides(&state).is_some());
                let close = checker.between(one, other).within(&state, tolerance);
                assert!(truth.metres > tolerance || close.is_some());
                let free = checker.between(one, other).collides(&state).is_none();
                assert!(!free || d.metres > 0.0, "{:?} {d:?} {one:?} {other:?}", levels[i]);
                if d.metres > 1e-5 {
                    assert!(checker.between(one, other).collides(&state).is_none(), "{:?} {d:?}", levels[i]);
                    assert!(checker.between(one, other).within(&state, d.metres * 0.99 - 1e-6).is_none());
                    let beyond = checker.between(one, other).within(&state, d.metres + 1e-5);
                    assert!(beyond.is_some(), "{:?} {d:?} {one:?} {other:?}", levels[i]);
                }
            }
        }
    }
    assert!(looser.iter().all(|n| *n > 20) && looser[0] > looser[3], "{looser:?}");
}

#[test]
fn a_larger_padding_never_clears_and_a_larger_scale_of_convex_shapes_never_widens() {
    let base = scene_of(8, |_| {});
    let everyone: Vec<GeometryId> = base.geometries().collect();
    let mut r = Random(8);
    let states: Vec<_> = (0..80).map(|_| random_state(&base, &mut r)).collect();
    let mut last: Option<Vec<(bool, f64)>> = None;
    for padding in [0.0, 0.005, 0.02, 0.08] {
        let scene = scene_of(8, |b| everyone.iter().for_each(|m| _ = b.padding(*m, padding)));
        let mut checker = Checker::new(&scene, CheckerOptions::default());
        let answers: Vec<_> =
            states.iter().map(|s| (checker.collides(s).is_some(), checker.distance(s).unwrap().metres)).collect();
        if let Some(before) = &last {
            assert!(before.iter().zip(&answers).all(|(b, a)| (!b.0 || a.0) && a.1 <= b.1 + 1e-12));
            assert!(before.iter().zip(&answers).any(|(b, a)| a.1 < b.1));
        }
        last = Some(answers);
    }
    let grown = scene_of(8, |b| {
        b.scale(link(0, 3), 1.3).scale(GeometryId::Object(ObjectId(3)), 1.2);
    });
    let (mut small, mut large) =
        (Checker::new(&base, CheckerOptions::default()), Checker::new(&grown, CheckerOptions::default()));
    let mut nearer = 0;
    for s in &states {
        let (before, after) = (small.distance(s).unwrap().metres, large.distance(s).unwrap().metres);
        // The state's boxes are those of the scene for which it was created.
        let mut t = SceneState::new(&grown);
        t.set_q(&grown, RobotId(0), s.q(RobotId(0))).unwrap();
        t.set_q(&grown, RobotId(1), s.q(RobotId(1))).unwrap();
        let after = after.min(large.distance(&t).unwrap().metres);
        assert!(after <= before + 1e-12);
        nearer += u32::from(after < before);
    }
    assert!(nearer > 0);
}

#[test]
fn invalid_joint_values_are_refused_with_the_name_of_the_joint() {
    let scene = scene_of(9, |_| {});
    let mut state = SceneState::new(&scene);
    let before = state.q(RobotId(1)).to_vec();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let message = state.set_q(&scene, RobotId(1), &[0.1, bad, 0.2]).unwrap_err().to_string();
        assert!(message.contains("`mixed`") && message.contains("`shoulder`"), "{message}");
    }
    let message = state.set_q(&scene, RobotId(0), &[0.1]).unwrap_err().to_string();
    assert!(message.contains("3 joint values (waist, shoulder, elbow), not 1"), "{message}");
    assert!(state.set_q(&scene, RobotId(2), &[]).is_err());
    assert_eq!(state.q(RobotId(1)), before);
    let nowhere = elbowroom_spatial::Pose::from_translation(elbowroom_spatial::Vec3::X * f64::NAN);
    assert!(state.place(&scene, ObjectId(0), nowhere).unwrap_err().to_string().contains("`thing 0`"));
    // An angle beyond all precision gives an answer, not a panic.
    state.set_q(&scene, RobotId(1), &[1e300, -1e300, 1e18]).unwrap();
    assert!(Checker::new(&scene, CheckerOptions::default()).distance(&state).is_some());
}

#[test]
fn invalid_tolerances_are_answered_conservatively() {
    let scene = scene_of(10, |_| {});
    let state = SceneState::new(&scene);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    assert!(checker.within(&state, f64::NAN).is_some() && checker.within(&state, f64::INFINITY).is_some());
    assert_eq!(checker.within(&state, -1.0).is_some(), checker.collides(&state).is_some());
}

#[test]
fn of_several_contacts_the_one_nearest_to_a_base_is_reported_without_weights() {
    let scene = scene_of(12, |_| {});
    let mut checker = Checker::new(&scene, CheckerOptions { weights: false, ..CheckerOptions::default() });
    let mut r = Random(12);
    let mut several = 0;
    for _ in 0..600 {
        let state = random_state(&scene, &mut r);
        let mut all = Vec::new();
        checker.contacts(&state, |c| all.push(c));
        assert_eq!(checker.collides(&state), all.first().copied());
        let depth = |m: GeometryId| if let GeometryId::Link { link, .. } = m { link.0 } else { usize::MAX };
        let root_most = |c: &elbowroom_scene::PairContact| depth(c.a).min(depth(c.b));
        assert!(all.windows(2).all(|w| root_most(&w[0]) <= root_most(&w[1])));
        several += u32::from(all.len() > 1);
    }
    assert!(several > 20, "{several}");
}

#[test]
fn learned_pairs_come_first_and_statistics_count_the_work() {
    let scene = scene_of(13, |_| {});
    let mut r = Random(4);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let touching = loop {
        let state = random_state(&scene, &mut r);
        if checker.collides(&state).is_some() {
            break state;
        }
    };
    for _ in 0..50 {
        checker.collides(&touching);
    }
    let contact = checker.collides(&touching).unwrap();
    let of = |c: &Checker| c.weights().find(|w| (w.0, w.1) == (contact.a, contact.b)).unwrap().2;
    assert!(checker.weights().all(|w| w.2 <= of(&checker)));
    checker.reset_stats();
    assert!(checker.collides(&touching).is_some());
    let stats = checker.stats();
    assert_eq!((stats.answered.l3, stats.answered.total(), stats.pairs_tested.l3), (1, 1, 1), "{stats:?}");
    assert_eq!(checker.last_level(), Level::L3);
    // Equal queries in equal order are answered equally on every thread.
    let run = || {
        let mut checker = Checker::new(&scene, CheckerOptions::default());
        let mut r = Random(77);
        let ask = |_| {
            let s = random_state(&scene, &mut r);
            (checker.collides(&s), checker.distance(&s))
        };
        (0..100).map(ask).collect::<Vec<_>>()
    };
    std::thread::scope(|scope| {
        let (x, y) = (scope.spawn(run), scope.spawn(run));
        assert_eq!(x.join().unwrap(), y.join().unwrap());
    });
}

#[test]
fn nearest_pairs_followed_along_a_path_stay_the_nearest() {
    let scene = scene_of(14, |_| {});
    let mut warm = Checker::new(&scene, CheckerOptions::default());
    let mut r = Random(14);
    for _ in 0..10 {
        let (from, to) = (r.q(), r.q());
        for step in 0..60 {
            let t = f64::from(step) / 60.0;
            let q: Vec<f64> = from.iter().zip(to).map(|(a, b)| a + (b - a) * t).collect();
            let mut state = SceneState::new(&scene);
            state.set_q(&scene, RobotId(0), &q).unwrap();
            state.set_q(&scene, RobotId(1), &[q[1], q[2] * 0.5, q[0]]).unwrap();
            let d = warm.distance(&state).unwrap();
            let cold = Checker::new(&scene, CheckerOptions::default()).distance(&state).unwrap();
            assert!((d.metres - cold.metres).abs() < 1e-12, "{d:?} {cold:?}");
            assert!((apart(&scene, &state, d.a, d.b) - d.metres).abs() < DOUBT);
        }
    }
}

#[test]
fn the_point_of_overlapping_meshes_does_not_depend_on_states_before() {
    let scene = scene_of(15, |_| {});
    let mut warm = Checker::new(&scene, CheckerOptions::default());
    let mut r = Random(15);
    // The links of the first robot are single meshes.
    let sides = (Selection::Robot(RobotId(0)), Selection::Robot(RobotId(0)));
    let mut overlapping = 0;
    for _ in 0..1000 {
        let state = random_state(&scene, &mut r);
        let d = warm.between(sides.0, sides.1).distance(&state).unwrap();
        if d.metres == 0.0 {
            let mut alone = Checker::new(&scene, CheckerOptions::default());
            let cold = alone.between(d.a.into(), d.b.into()).distance(&state).unwrap();
            assert_eq!((d.on_a, d.on_b), (cold.on_a, cold.on_b));
            overlapping += 1;
        }
    }
    assert!(overlapping > 10, "{overlapping}");
}

#[test]
fn a_pair_that_does_not_count_in_this_state_bounds_no_other() {
    let scene = scene_of(16, |_| {});
    // Of so few samples most pairs that meet have none in which they do.
    let mut matrix = scene.allowed_collision_matrix().sampled(&scene, 5);
    assert!(matrix.accept_suggestions() > 0);
    let scene = scene.with_allowed_collision_matrix(matrix).unwrap();
    let mut warm = Checker::new(&scene, CheckerOptions::default());
    let mut r = Random(16);
    let chain = &scene.robots()[0].robot.chain;
    let upper = chain.joints()[chain.active_joints()[0].0].limits.upper;
    for _ in 0..300 {
        let mut q = r.q();
        // Beyond the limits every pair counts.
        for over in [0.01, -0.01] {
            q[0] = upper + over;
            let mut state = SceneState::new(&scene);
            state.set_q(&scene, RobotId(0), &q).unwrap();
            let cold = Checker::new(&scene, CheckerOptions::default()).distance(&state);
            assert_eq!(warm.distance(&state).map(|d| d.metres), cold.map(|d| d.metres));
        }
    }
}

#[test]
fn links_of_several_shapes_collide_with_a_tilted_half_space() {
    let mut robot = elbowroom_robot::example::arm().unwrap();
    let tip = robot.chain.tip();
    let balls = [0.0, 0.1].map(|x| Collider {
        name: String::new(),
        shape: Shape::Sphere(Sphere { radius: 0.02 }),
        in_link: Pose::from_translation(Vec3::X * x),
    });
    robot.colliders[tip.0] = balls.to_vec();
    let mut builder = Scene::builder();
    let id = builder.robot("arm", robot, Pose::IDENTITY);
    // Everything within five metres is below its plane.
    let rotation = Rotation::from_axis_angle(Vec3::X, 2.0);
    let in_world = Pose::new(rotation, rotation * (Vec3::Z * 5.0));
    builder.object(Object { name: "ground".into(), shape: Shape::HalfSpace(HalfSpace), in_world });
    let scene = builder.build().unwrap();
    let mut state = SceneState::new(&scene);
    state.set_q(&scene, id, &vec![0.1; scene.robots()[0].robot.chain.dof()]).unwrap();
    for options in options() {
        let mut checker = Checker::new(&scene, options);
        assert!(checker.collides(&state).is_some() && checker.within(&state, 0.1).is_some(), "{options:?}");
        let ground = Selection::Object(ObjectId(0));
        let of_tip = Selection::Link { robot: id, link: tip };
        assert!(checker.between(of_tip, ground).collides(&state).is_some(), "{options:?}");
    }
}
