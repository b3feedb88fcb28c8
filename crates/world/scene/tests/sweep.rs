//! Sweeps between two configurations: compared with dense samples, and for contacts that samples would miss.

use crate::common::rx60b;
use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::common::{Random, RandomGeometry, apart, link, scene_of};

use elbowroom_kinematics::LinkId;
use elbowroom_proximity::ccd::ConstantTwist;
use elbowroom_proximity::{Capsule, Cuboid, HalfSpace, Shape, TriMesh, tessellate};
use elbowroom_robot::{GeometryId, ObjectId, RobotId};

use elbowroom_scene::{
    Attachment, Checker, CheckerOptions, Level, Object, PairEdit, Scene, SceneState, Selection, SweepHit, SweepMove,
    SweepOptions, example,
};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_testkit::extent::amount;

/// Distance (m) that exceeds the rounding of poses and distances at 1 m.
const DOUBT: f64 = 1e-9;

fn at(scene: &Scene, start: &SceneState, moves: &[SweepMove], t: f64) -> SceneState {
    let mut state = start.clone();
    for m in moves {
        match m {
            SweepMove::Robot { robot, to } => {
                let q: Vec<f64> = start.q(*robot).iter().zip(*to).map(|(a, b)| a + (b - a) * t).collect();
                state.set_q(scene, *robot, &q).unwrap();
            }
            SweepMove::Object { object, path } => state.place(scene, *object, path.pose(t)).unwrap(),
        }
    }
    state
}

/// Checks an answer against `samples` instants, and returns the first sampled contact.
fn check(
    checker: &mut Checker,
    (one, other): (Selection, Selection),
    start: &SceneState,
    moves: &[SweepMove],
    options: &SweepOptions,
    hit: Option<&SweepHit>,
    samples: u32,
) -> Option<f64> {
    let scene = checker.scene();
    if let Some(h) = hit {
        assert!(h.certain, "{h:?}");
        let state = at(scene, start, moves, h.time);
        // The pair itself, tested directly; other pairs may be nearer only at the start.
        let padding = scene.allowed_collision_matrix().get(h.a, h.b).map_or(0.0, |e| e.margin_m);
        let metres = (apart(scene, &state, h.a, h.b) - padding).max(0.0);
        assert!((metres - h.metres).abs() < DOUBT, "{h:?} {metres}");
        assert!(metres <= options.clearance_m + options.tolerance_m + DOUBT, "{h:?}");
        if let Some(d) = checker.between(one, other).distance(&state).filter(|_| !h.at_start()) {
            assert!(d.metres > options.clearance_m, "{h:?} {d:?}");
        }
    }
    let end = hit.map_or(1.0, |h| h.time);
    for i in 0..=samples {
        let t = f64::from(i) / f64::from(samples);
        let state = at(scene, start, moves, t);
        if let Some(c) = checker.between(one, other).within(&state, options.clearance_m) {
            assert!(hit.is_some_and(|h| h.time <= t), "missed {c:?} at {t}: {hit:?}");
            return Some(t);
        }
        assert!(t <= end || hit.is_some());
    }
    None
}

fn start(scene: &Scene, r: &mut Random) -> SceneState {
    let mut state = SceneState::new(scene);
    for robot in 0..scene.robots().len() {
        state.set_q(scene, RobotId(robot), &r.q()).unwrap();
    }
    state
}

const ALL: (Selection, Selection) = (Selection::All, Selection::All);

#[test]
fn two_robots_among_objects_of_all_kinds_agree_with_dense_samples() {
    let scene = scene_of(61, |b| {
        b.padding(link(0, 3), 0.01);
    });
    let mut r = Random(61);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let (mut free, mut hits, mut later) = (0, 0, 0);
    for round in 0..400 {
        let mut start = start(&scene, &mut r);
        let mut to = [r.q(), r.q()];
        // Every other motion is short and starts free.
        if round % 2 == 0 {
            while checker.collides(&start).is_some() {
                start.set_q(&scene, RobotId(0), &r.q()).unwrap();
                start.set_q(&scene, RobotId(1), &r.q()).unwrap();
            }
            for (robot, to) in to.iter_mut().enumerate() {
                *to = std::array::from_fn(|i| start.q(RobotId(robot))[i] + r.between(-0.3, 0.3));
            }
        }
        let both =
            [SweepMove::Robot { robot: RobotId(0), to: &to[0] }, SweepMove::Robot { robot: RobotId(1), to: &to[1] }];
        let moves = &both[..=(round % 2)];
        let options = SweepOptions { clearance_m: if round % 3 == 0 { 0.02 } else { 0.0 }, ..SweepOptions::default() };
        let selection = [
            ALL,
            (Selection::Robot(RobotId(0)), Selection::Robot(RobotId(1))),
            (Selection::Robot(RobotId(0)), Selection::Objects),
        ][round % 5 % 3];
        let hit = checker.between(selection.0, selection.1).sweep(&start, moves, &options).unwrap();
        check(&mut checker, selection, &start, moves, &options, hit.as_ref(), 60);
        match hit {
            None => free += 1,
            Some(h) if h.at_start() => hits += 1,
            Some(_) => later += 1,
        }
    }
    assert!(free > 50 && hits > 20 && later > 50, "{free} free, {hits} at the start, {later} later");
}

#[test]
fn the_first_of_all_contacts_is_reported() {
    let scene = scene_of(62, |_| {});
    let mut r = Random(62);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let options = SweepOptions { tolerance_m: 1e-6, ..SweepOptions::default() };
    let mut seen = 0;
    for _ in 0..40 {
        let start = start(&scene, &mut r);
        let to = r.q();
        let moves = [SweepMove::Robot { robot: RobotId(0), to: &to }];
        let Some(hit) = checker.sweep(&start, &moves, &options).unwrap().filter(|h| !h.at_start()) else { continue };
        seen += 1;
        // Every single pair: no hit is earlier than the answer by more than the tolerance allows.
        for o in (0..scene.objects().len()).map(ObjectId) {
            let alone =
                checker.between(Selection::Robot(RobotId(0)), Selection::Object(o)).sweep(&start, &moves, &options);
            assert!(alone.unwrap().is_none_or(|h| h.time >= hit.time - 1e-4), "{hit:?}");
        }
        let again = Checker::new(&scene, CheckerOptions::default()).sweep(&start, &moves, &options).unwrap().unwrap();
        assert_eq!((again.time, again.a, again.b), (hit.time, hit.a, hit.b), "earlier queries change nothing");
    }
    assert!(seen > 10, "{seen}");
}

#[test]
fn what_rests_in_contact_is_left_out_if_only_moving_pairs_count() {
    let scene = scene_of(63, |_| {});
    let mut r = Random(63);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let every = SweepOptions::default();
    let moving = SweepOptions { moving_only: true, ..every };
    let (mut free_beside_contact, mut hits) = (0, 0);
    for _ in 0..600 {
        let start = start(&scene, &mut r);
        let to: Vec<f64> = start.q(RobotId(0)).iter().map(|q| q + r.between(-0.2, 0.2)).collect();
        let moves = [SweepMove::Robot { robot: RobotId(0), to: &to }];
        let hit = checker.sweep(&start, &moves, &moving).unwrap();
        let own = checker.between(Selection::Robot(RobotId(0)), Selection::All).sweep(&start, &moves, &every).unwrap();
        if own.is_none_or(|own| !own.at_start()) {
            assert_eq!(hit.map(|h| (h.time, h.a, h.b)), own.map(|h| (h.time, h.a, h.b)));
            hits += usize::from(hit.is_some());
            free_beside_contact += usize::from(hit.is_none() && checker.collides(&start).is_some());
        }
    }
    assert!(free_beside_contact > 10 && hits > 10, "{free_beside_contact} free beside a contact, {hits} hits");
}

/// The example arm swings about its waist past one object.
fn past(shape: Shape, in_world: Pose) -> Scene {
    let mut builder = Scene::builder();
    builder.robot("arm", elbowroom_robot::example::arm().unwrap(), Pose::IDENTITY);
    builder.object(Object { name: "thing".into(), shape, in_world });
    builder.build().unwrap()
}

#[test]
fn a_plate_of_a_tenth_of_a_millimetre_and_a_wire_are_not_missed() {
    let plate = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.2, 5e-5, 0.2) });
    let wire = Shape::Capsule(Capsule { half_length: 0.4, radius: 1e-4 });
    let meshed = |s: &Shape| {
        let (vertices, triangles) = tessellate::tessellate(s, 0.001);
        Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()))
    };
    let there = Pose::from_translation(Vec3::new(0.5, 0.0, 0.4));
    for shape in [meshed(&plate), plate, meshed(&wire), wire] {
        let scene = past(shape, there);
        let mut checker = Checker::new(&scene, CheckerOptions::default());
        let mut start = SceneState::new(&scene);
        let mut r = Random(7);
        for _ in 0..50 {
            // Ends on both sides, wherever the samples would fall.
            let (from, to) = (r.between(-2.5, -0.3), r.between(0.3, 2.5));
            start.set_q(&scene, RobotId(0), &[from, 1.4, 0.2]).unwrap();
            let moves = [SweepMove::Robot { robot: RobotId(0), to: &[to, 1.4, 0.2] }];
            let options = SweepOptions { tolerance_m: 1e-5, ..SweepOptions::default() };
            let hit = checker.sweep(&start, &moves, &options).unwrap().expect("in the way");
            assert!(hit.certain && hit.metres <= 1e-5 && hit.b == GeometryId::Object(ObjectId(0)), "{hit:?}");
            // The arm is before the object, by about its own half width.
            let waist = from + (to - from) * hit.time;
            assert!(waist < -0.05 && waist > -0.3, "{waist}");
            let back = [SweepMove::Robot { robot: RobotId(0), to: &[from, 0.1, 0.2] }];
            assert_eq!(checker.sweep(&start, &back, &options).unwrap(), None);
        }
    }
}

#[test]
fn adjacent_links_never_hit_and_distant_links_do() {
    let robot = rx60b::robot();
    let mut builder = Scene::builder();
    builder.robot("rx60b", robot, Pose::IDENTITY);
    let scene = builder.build().unwrap();
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut start = SceneState::new(&scene);
    let mut r = Random(9);
    let mut found = 0;
    for _ in 0..60 {
        let mut q = || rx60b::limits().map(|(l, u)| r.between(l, u)).collect::<Vec<_>>();
        let to = q();
        start.set_q(&scene, RobotId(0), &q()).unwrap();
        let moves = [SweepMove::Robot { robot: RobotId(0), to: &to }];
        let options = SweepOptions::default();
        let hit = checker.sweep(&start, &moves, &options).unwrap();
        check(&mut checker, ALL, &start, &moves, &options, hit.as_ref(), 60);
        let Some(h) = hit else { continue };
        let (GeometryId::Link { link: a, .. }, GeometryId::Link { link: b, .. }) = (h.a, h.b) else { panic!() };
        assert!(a.0.abs_diff(b.0) > 1, "{h:?}");
        found += 1;
    }
    assert!((5..55).contains(&found), "{found}");
    // The arm folds onto its own base: only the ends of the chain meet.
    start.set_q(&scene, RobotId(0), &[0.0; 6]).unwrap();
    let fold = [SweepMove::Robot { robot: RobotId(0), to: &[0.0, 2.2, 2.3, 0.0, 0.0, 0.0] }];
    let hit = checker.sweep(&start, &fold, &SweepOptions::default()).unwrap().expect("into its base");
    assert!(!hit.at_start() && hit.certain);
}

#[test]
fn an_attached_object_moves_along() {
    let mut builder = Scene::builder();
    builder.robot("arm", elbowroom_robot::example::arm().unwrap(), Pose::IDENTITY);
    let rod = Shape::Capsule(Capsule { half_length: 0.2, radius: 0.01 });
    builder.object(Object { name: "rod".into(), shape: rod, in_world: Pose::IDENTITY });
    let wall = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.3, 0.01, 0.3) });
    let wall_at = Pose::from_translation(Vec3::new(1.3, 0.0, 0.4));
    builder.object(Object { name: "wall".into(), shape: wall, in_world: wall_at });
    let scene = builder.build().unwrap();
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut start = SceneState::new(&scene);
    let (from, to) = ([-1.0, 1.5, 0.0], [1.0, 1.5, 0.0]);
    start.set_q(&scene, RobotId(0), &from).unwrap();
    start.place(&scene, ObjectId(0), Pose::from_translation(Vec3::Z * 3.0)).unwrap();
    let swing = [SweepMove::Robot { robot: RobotId(0), to: &to }];
    let options = SweepOptions::default();
    assert_eq!(checker.sweep(&start, &swing, &options).unwrap(), None, "the arm alone passes");
    let in_link = Pose::from_translation(Vec3::Z * 0.56);
    let attachment =
        Attachment { robot: RobotId(0), link: LinkId(3), in_link, touch_links: vec![], visiting_links: vec![] };
    start.attach_at(&scene, ObjectId(0), attachment).unwrap();
    let hit = checker.sweep(&start, &swing, &options).unwrap().expect("the rod does not");
    assert_eq!((hit.a, hit.b), (GeometryId::Object(ObjectId(0)), GeometryId::Object(ObjectId(1))));
    check(&mut checker, ALL, &start, &swing, &options, Some(&hit), 500);
    // An attached object cannot have its own path.
    let path = Pose::IDENTITY;
    let error = checker.sweep(&start, &[SweepMove::Object { object: ObjectId(0), path: &path }], &options).unwrap_err();
    assert!(error.to_string().contains("attached to `arm/forearm`"), "{error}");
}

#[test]
fn objects_on_paths_meet_arms_that_move_and_links_that_do_not() {
    let scene = scene_of(64, |_| {});
    let mut r = Random(64);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let options = SweepOptions::default();
    let mut hits = 0;
    for _ in 0..120 {
        let start = start(&scene, &mut r);
        let to = r.q();
        let path =
            ConstantTwist { start: r.pose(1.0), pivot: r.vec3(0.5), velocity: r.vec3(1.0), rotation: r.vec3(2.0) };
        let moves =
            [SweepMove::Object { object: ObjectId(5), path: &path }, SweepMove::Robot { robot: RobotId(1), to: &to }];
        let selection = (Selection::Object(ObjectId(5)), Selection::Robots);
        let hit = checker.between(selection.0, selection.1).sweep(&start, &moves, &options).unwrap();
        check(&mut checker, selection, &start, &moves, &options, hit.as_ref(), 60);
        hits += usize::from(hit.is_some_and(|h| !h.at_start()));
    }
    assert!((8..100).contains(&hits), "{hits}");
    // The base is stationary and forms no pair with other stationary geometry.
    let scene = past(Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.02) }), Pose::from_translation(Vec3::Y));
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let path = ConstantTwist::linear(Pose::from_translation(Vec3::new(0.0, 1.0, 0.1)), Vec3::Y * -2.0);
    let moves = [SweepMove::Object { object: ObjectId(0), path: &path }];
    let hit = checker.sweep(&SceneState::new(&scene), &moves, &options).unwrap().expect("runs into the base");
    assert_eq!((hit.a, hit.b), (link(0, 0), GeometryId::Object(ObjectId(0))));
    assert!((hit.time - (1.0 - 0.14) / 2.0).abs() <= 1e-4, "{hit:?}");
}

#[test]
fn a_start_in_contact_is_time_0_and_a_sweep_without_motion_is_the_query_of_the_start() {
    let scene = scene_of(65, |_| {});
    let mut r = Random(65);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut seen = [0; 2];
    for _ in 0..100 {
        let start = start(&scene, &mut r);
        let to = r.q();
        let options = SweepOptions::default();
        let touching = checker.collides(&start).is_some();
        let hit = checker.sweep(&start, &[SweepMove::Robot { robot: RobotId(0), to: &to }], &options).unwrap();
        if touching {
            assert!(hit.is_some_and(|h| h.at_start() && h.certain && h.metres <= options.tolerance_m), "{hit:?}");
        }
        let rest = checker.sweep(&start, &[], &options).unwrap();
        assert!(!touching || rest.is_some());
        assert!(rest.is_none_or(|h| h.at_start() && h.certain && h.metres <= options.tolerance_m));
        seen[usize::from(touching)] += 1;
    }
    assert!(seen[0] > 10 && seen[1] > 10, "{seen:?}");
}

#[test]
fn a_larger_clearance_or_tolerance_is_never_later() {
    let scene = scene_of(66, |_| {});
    let mut r = Random(66);
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    // With a tolerance of 0, the search continues to the last digit.
    for _ in 0..amount(15, 60) {
        let start = start(&scene, &mut r);
        let to = r.q();
        let moves = [SweepMove::Robot { robot: RobotId(0), to: &to }];
        let mut time = |clearance_m, tolerance_m| {
            let options = SweepOptions { clearance_m, tolerance_m, ..SweepOptions::default() };
            checker.sweep(&start, &moves, &options).unwrap().map_or(f64::INFINITY, |h| h.time)
        };
        let clearances = [0.0, 1e-4, 1e-3, 0.01, 0.05, 0.2].map(|c| time(c, 1e-4));
        assert!(clearances.is_sorted_by(|a, b| a >= b), "{clearances:?}");
        let tolerances = [0.0, 1e-8, 1e-6, 1e-4, 1e-3, 1e-2].map(|t| time(0.0, t));
        assert!(tolerances.is_sorted_by(|a, b| a >= b), "{tolerances:?}");
        assert_eq!(time(f64::NAN, 1e-4), 0.0);
        assert_eq!(time(-1.0, 1e-4), clearances[0]);
    }
}

#[test]
fn no_level_or_option_misses_a_contact() {
    let scene = scene_of(67, |b| {
        b.padding(GeometryId::Object(ObjectId(3)), 0.02);
    });
    let mut r = Random(67);
    let mut exact = Checker::new(&scene, CheckerOptions::default());
    let mut others = Vec::new();
    for start in [Level::L2, Level::L3] {
        others.push(CheckerOptions { start, matrix: false, ..CheckerOptions::default() });
    }
    for level in [Level::L1, Level::L2, Level::boxes(3), Level::Capsule, Level::Hull, Level::L3] {
        others.push(CheckerOptions { level, ..CheckerOptions::default() });
    }
    let mut others: Vec<_> = others.into_iter().map(|o| Checker::new(&scene, o)).collect();
    for _ in 0..40 {
        let start = start(&scene, &mut r);
        let to: Vec<f64> = start.q(RobotId(0)).iter().map(|q| q + r.between(-0.4, 0.4)).collect();
        let moves = [SweepMove::Robot { robot: RobotId(0), to: &to }];
        let options = SweepOptions { tolerance_m: 1e-6, ..SweepOptions::default() };
        let truth = exact.sweep(&start, &moves, &options).unwrap();
        for other in &mut others {
            let hit = other.sweep(&start, &moves, &options).unwrap();
            let (t, h) = (truth.map_or(2.0, |h| h.time), hit.map_or(2.0, |h| h.time));
            assert!(h <= t + 1e-4, "{:?}: {hit:?} {truth:?}", other.options());
            if matches!(other.options().level, Level::Auto | Level::L3) {
                assert!((h - t).abs() < 1e-4, "{:?}: {hit:?} {truth:?}", other.options());
            }
        }
    }
}

#[test]
fn waypoints_are_segments_and_the_segment_of_the_hit_is_reported() {
    let scene = example::two_arms();
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut start = SceneState::new(&scene);
    start.set_q(&scene, RobotId(0), &[-0.9, 1.3, 0.6]).unwrap();
    let options = SweepOptions::default();
    let over = [[-0.9, 0.2, 0.6], [0.9, 0.2, 0.6], [0.9, 1.3, 0.6], [-0.9, 1.3, 0.6]];
    let (segment, hit) = checker.sweep_path(&start, RobotId(0), &over, &options).unwrap().unwrap();
    assert_eq!(segment, 3);
    start.set_q(&scene, RobotId(0), &over[2]).unwrap();
    let alone =
        checker.sweep(&start, &[SweepMove::Robot { robot: RobotId(0), to: &over[3] }], &options).unwrap().unwrap();
    assert!((alone.time - hit.time).abs() < 1e-9 && (alone.a, alone.b) == (hit.a, hit.b));
    let none: [[f64; 3]; 0] = [];
    assert_eq!(checker.sweep_path(&start, RobotId(0), &none, &options).unwrap(), None);
}

#[test]
fn unknown_motions_are_refused_or_a_hit() {
    let scene = scene_of(68, |b| {
        b.edit(link(0, 2), GeometryId::Object(ObjectId(1)), PairEdit::Skip("behind glass".into()));
    });
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let start = SceneState::new(&scene);
    let options = SweepOptions::default();
    let mut refused = |moves: &[SweepMove], word: &str| {
        let error = checker.sweep(&start, moves, &options).unwrap_err().to_string();
        assert!(error.contains(word), "{error}");
    };
    refused(&[SweepMove::Robot { robot: RobotId(0), to: &[0.0, f64::NAN, 0.0] }], "shoulder");
    refused(&[SweepMove::Robot { robot: RobotId(0), to: &[0.0; 2] }], "waist, shoulder, elbow");
    refused(&[SweepMove::Robot { robot: RobotId(7), to: &[0.0; 3] }], "no robot 7");
    refused(
        &[SweepMove::Robot { robot: RobotId(0), to: &[0.0; 3] }, SweepMove::Robot { robot: RobotId(0), to: &[0.1; 3] }],
        "twice",
    );
    let lost = ConstantTwist::linear(Pose::IDENTITY, Vec3::X * f64::NAN);
    refused(&[SweepMove::Object { object: ObjectId(1), path: &lost }], "`thing 1`");
    refused(&[SweepMove::Object { object: ObjectId(99), path: &Pose::IDENTITY }], "no object 99");
    assert!(checker.sweep_path(&start, RobotId(0), &[[0.1; 3], [f64::INFINITY; 3]], &options).is_err());
    // A rotating half-space has points of any speed: nothing is proven, and the hit is not certain.
    let turning = ConstantTwist::screw(Pose::from_translation(Vec3::Z * -3.0), Vec3::ZERO, Vec3::Z * 0.1, 0.0);
    let floor = scene.objects().iter().position(|o| matches!(o.shape, Shape::HalfSpace(HalfSpace))).unwrap();
    let hit = checker
        .sweep(&start, &[SweepMove::Object { object: ObjectId(floor), path: &turning }], &options)
        .unwrap()
        .unwrap();
    assert!(hit.time <= 1.0 && (!hit.certain || hit.metres <= options.tolerance_m), "{hit:?}");
    // Angles beyond all precision, and a search that runs out of steps.
    let far = [SweepMove::Robot { robot: RobotId(0), to: &[1e300, -1e300, 0.0] }];
    assert!(checker.sweep(&start, &far, &options).unwrap().is_some());
    let mut r = Random(68);
    let mut cut = 0;
    for _ in 0..60 {
        let start = self::start(&scene, &mut r);
        let to = r.q();
        let moves = [SweepMove::Robot { robot: RobotId(0), to: &to }];
        let whole = checker.sweep(&start, &moves, &options).unwrap();
        for max_steps in [0, 1, 3, 10] {
            let few = SweepOptions { max_steps, ..options };
            let hit = checker.sweep(&start, &moves, &few).unwrap();
            assert!(hit.is_none_or(|h| h.steps <= max_steps));
            let (t, h) = (whole.map_or(2.0, |h| h.time), hit.map_or(2.0, |h| h.time));
            assert!(h <= t && (hit.is_none() || hit.unwrap().certain || h < 1.0), "{hit:?} {whole:?}");
            cut += usize::from(hit.is_some_and(|h| !h.certain));
        }
    }
    assert!(cut > 20, "{cut}");
}

/// The example RX60B among thin plates and wires.
fn cage(r: &mut Random) -> Scene {
    let mut builder = Scene::builder();
    builder.robot("rx60b", rx60b::robot(), Pose::IDENTITY);
    for i in 0..8 {
        let thin = r.between(2e-4, 1e-3);
        let size = r.between(0.08, 0.25);
        let shape = if i % 2 == 0 {
            Shape::Cuboid(Cuboid { half_extents: Vec3::new(size, size, thin) })
        } else {
            Shape::Capsule(Capsule { half_length: 1.5 * size, radius: thin })
        };
        // Half of the plates and wires are meshes.
        let shape = if i % 4 < 2 {
            shape
        } else {
            let (vertices, triangles) = tessellate::tessellate(&shape, 0.1 * thin);
            Shape::Mesh(Arc::new(TriMesh::new(vertices, triangles).unwrap()))
        };
        let mut in_world = r.pose(0.0);
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / 8.0).sin_cos();
        let far = r.between(0.45, 0.7);
        in_world.translation = Vec3::new(far * cos, far * sin, r.between(0.1, 0.9));
        builder.object(Object { name: format!("thin {i}"), shape, in_world });
    }
    builder.build().unwrap()
}

#[test]
fn random_motions_of_the_rx60b_among_thin_plates_and_wires() {
    let (motions, samples) = (amount(300, 100_000), 40);
    let mut r = Random(70);
    let (mut time, mut asking) = (Duration::ZERO, Duration::ZERO);
    let (mut free, mut at_start, mut later, mut missed_by_samples, mut steps) = (0, 0, 0, 0, 0_u64);
    let mut done = 0;
    while done < motions {
        let scene = cage(&mut r);
        let mut checker = Checker::new(&scene, CheckerOptions::default());
        let mut start = SceneState::new(&scene);
        let count = (motions - done).min(1000);
        for i in 0..count {
            let mut q = || rx60b::limits().map(|(l, u)| r.between(l, u)).collect::<Vec<_>>();
            let mut to = q();
            start.set_q(&scene, RobotId(0), &q()).unwrap();
            // From any start, and from a free start, far and near.
            if i % 4 > 0 {
                while checker.collides(&start).is_some() {
                    start.set_q(&scene, RobotId(0), &q()).unwrap();
                }
            }
            if i % 4 > 1 {
                to = start.q(RobotId(0)).iter().map(|q| q + r.between(-0.6, 0.6)).collect();
            }
            let moves = [SweepMove::Robot { robot: RobotId(0), to: &to }];
            let options = SweepOptions::default();
            let begin = Instant::now();
            let hit = checker.sweep(&start, &moves, &options).unwrap();
            time += begin.elapsed();
            let begin = Instant::now();
            if let Some(h) = hit {
                steps += u64::from(h.steps);
                if let (GeometryId::Link { link: a, .. }, GeometryId::Link { link: b, .. }) = (h.a, h.b) {
                    assert!(a.0.abs_diff(b.0) > 1, "neighbours: {h:?}");
                }
            }
            // Occasionally compared with very many samples.
            let samples = if i % 100 == 0 { 50 * samples } else { samples };
            let sampled = check(&mut checker, ALL, &start, &moves, &options, hit.as_ref(), samples);
            asking += begin.elapsed();
            missed_by_samples += usize::from(hit.is_some() && sampled.is_none());
            match hit {
                None => free += 1,
                Some(h) if h.at_start() => at_start += 1,
                Some(_) => later += 1,
            }
        }
        done += count;
    }
    println!(
        "{motions} motions: {free} free, {at_start} in contact at the start, {later} hits later, of which {missed_by_samples} \
         that {samples} samples miss; {:.1} µs per motion, {:.1} distances per hit; checked in {:.1} s",
        time.as_secs_f64() * 1e6 / f64::from(motions),
        steps as f64 / f64::from(at_start + later),
        asking.as_secs_f64()
    );
    assert!(free > motions / 20 && later > motions / 20 && missed_by_samples > 0);
}
