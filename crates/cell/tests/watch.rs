//! Frames in, motion out: around what comes between, and safe where nothing can be seen.

mod watched;

use std::path::Path;
use std::sync::Arc;

use elbowroom_cell::watch::{Doing, Reason, Sentry, Shot, Step, Watch, WatchError, WatchSettings};
use elbowroom_proximity::{Cuboid, Shape, impact::Steady};
use elbowroom_scene::{Checker, Move, Object, Options, Scene, SceneState, SweepOptions};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_vision::render::Solid;
use elbowroom_vision::{Calibration, FloorHomography, Point2, Sight, encode_png};
use watched::{A, B, PERIOD_S, Stage, TICK_S, arm, camera, limits, radians, seeing};

const SIZE: Vec3 = Vec3::new(0.5, 0.5, 1.5);

fn trolley(at: Point2) -> Solid {
    Solid::cuboid(at, SIZE, 0.0, 215)
}

fn is_at(q: &[f64], goal: [f64; 6]) -> bool {
    q.iter().zip(radians(goal)).all(|(a, b)| (a - b).abs() < 1e-9)
}

/// Joint values, speeds and accelerations of a run of ticks.
fn check_motion(steps: &[Step]) {
    let most = limits();
    for w in steps.windows(2) {
        for i in 0..3 {
            let moved = (w[1].q[i] - w[0].q[i]).abs();
            assert!(moved <= most.velocity[i] * TICK_S * 1.01, "jump of {moved} rad");
            let change = (w[1].qd[i] - w[0].qd[i]).abs() / TICK_S;
            // A tenth more where a stop is made while a corner takes all.
            assert!(change <= most.acceleration[i] * 1.15, "joint {i}: {change} rad/s²");
        }
    }
}

#[test]
fn the_arm_goes_around_what_crosses_and_nothing_is_hit() {
    let mut stage = Stage::new();
    let shape = Shape::Cuboid(Cuboid { half_extents: SIZE * 0.5 });
    let pose = |t: f64| Pose::from_translation(Vec3::new(1.9, -2.0 + 0.45 * (t - 1.2), 0.75));
    let mut builder = Scene::builder();
    builder.robot("kr125", stage.arm.robot.clone(), Pose::IDENTITY);
    builder.object(Object { name: "trolley".into(), shape, in_world: pose(1.2) });
    let scene = builder.build().unwrap();
    let mut judge = Checker::new(&scene, Options::default());
    let mut state = SceneState::new(&scene);
    state.set_q(&scene, 0, &stage.q).unwrap();
    let (mut next, mut arrivals, mut in_motion, mut all) = (B, 0, 0, Vec::new());
    stage.guide.go_to(&radians(next)).unwrap();
    for _ in 0..220 {
        let from = stage.t;
        let at = pose(from).translation;
        let (sighting, outlook, steps) = stage.step(&[trolley(Point2::new(at.x, at.y))]);
        assert!(sighting.is_clear());
        in_motion += usize::from(outlook.in_motion);
        for (n, step) in steps.iter().enumerate() {
            let t = from + TICK_S * n as f64;
            let way = Steady::linear(pose(t), pose(t + TICK_S).translation - pose(t).translation);
            let moves = [Move::Robot { robot: 0, to: &step.q }, Move::Object { object: 0, path: &way }];
            let hit = judge.sweep(&state, &moves, &SweepOptions::default()).unwrap();
            assert_eq!(hit, None, "at {t}");
            state.set_q(&scene, 0, &step.q).unwrap();
        }
        let is_there = is_at(&stage.q, next);
        all.extend(steps);
        if is_there {
            (next, arrivals) = (if next == B { A } else { B }, arrivals + 1);
            stage.guide.go_to(&radians(next)).unwrap();
        }
    }
    check_motion(&all);
    assert!(arrivals >= 2 && in_motion >= 3, "{arrivals} stations, {in_motion} changes while moving");
}

#[test]
fn without_pictures_the_arm_slows_to_a_stop_says_why_and_goes_on_when_they_come_back() {
    let mut stage = Stage::new();
    stage.guide.go_to(&radians(B)).unwrap();
    let mut all: Vec<Step> = (0..15).flat_map(|_| stage.step(&[]).2).collect();
    assert_eq!(all.last().unwrap().doing, Doing::Going);
    let dark: Vec<Step> = (0..40).flat_map(|_| stage.ticks()).collect();
    let first = dark.iter().position(|s| matches!(s.doing, Doing::Slowing(_))).unwrap();
    // 150 ms after the stamp of the last picture.
    let silent_s = TICK_S * (first as f64 + 1.0) + PERIOD_S;
    assert!((0.15..0.16).contains(&silent_s), "{silent_s}");
    let stands = dark.last().unwrap();
    assert!(matches!(&stands.doing, Doing::Waiting(Reason::NoPicture { age_s }) if *age_s > 1.0), "{:?}", stands.doing);
    assert!(stands.qd == [0.0; 3] && !is_at(&stands.q, B));
    all.extend(dark);
    all.extend((0..60).flat_map(|_| stage.step(&[]).2));
    assert!(is_at(&all.last().unwrap().q, B), "{:?}", all.last());
    check_motion(&all);
}

#[test]
fn frames_that_are_no_use_are_refused_with_a_reason_and_free_nothing() {
    let mut stage = Stage::new();
    let here = [trolley(Point2::new(1.9, 0.0))];
    let (sighting, ..) = stage.step(&here);
    let blocked = stage.watch.map().table().blocked();
    assert!(blocked > 0 && sighting.entered.len() == 1 && sighting.blocked == blocked);
    let good = stage.shoot(&[]);
    let small = {
        let mut frame = elbowroom_vision::Frame::default();
        frame.fill(8, 6, elbowroom_vision::Channels::Grey, |bytes| bytes.resize(48, 7)).unwrap();
        encode_png(&frame).unwrap()
    };
    let q = stage.q.clone();
    let mut see = |bytes: &[u8], t: f64, q: &[f64]| {
        let error = stage.watch.see(bytes, Path::new("camera.png"), t, q).unwrap_err();
        assert_eq!(stage.watch.map().table().blocked(), blocked, "{error}");
        error.to_string()
    };
    let t = 10.0;
    assert!(see(&[], t, &q).contains("is empty"));
    assert!(see(&good[..good.len() / 2], t, &q).contains("cannot be decoded"));
    assert!(see(b"no picture at all", t, &q).contains("PNG"));
    assert!(see(&small, t, &q).contains("320"));
    assert!(see(&good, 0.1, &q).contains("camera.png"));
    assert!(see(&good, f64::NAN, &q).contains("NaN"));
    assert!(see(&good, t, &q[..5]).contains("5 joint values"));
    assert!(see(&good, t, &[f64::NAN; 6]).contains("finite"));
    // A good one afterwards is taken.
    assert!(stage.watch.see(&good, Path::new("camera.png"), t, &q).unwrap().is_clear());
}

#[test]
fn a_blinded_camera_stops_the_arm() {
    let mut stage = Stage::new();
    stage.guide.go_to(&radians(B)).unwrap();
    (0..10).for_each(|_| _ = stage.step(&[]));
    let mut last = None;
    for _ in 0..25 {
        stage.shoot(&[]);
        stage.frame.pixels_mut().fill(255);
        let bytes = encode_png(&stage.frame).unwrap();
        let sighting = stage.send(&bytes).unwrap();
        assert!(matches!(sighting.sight, Sight::Blind(_)));
        stage.guide.look(&sighting);
        last = stage.ticks().pop();
    }
    assert!(matches!(last.unwrap().doing, Doing::Waiting(Reason::NoPicture { .. })));
}

#[test]
fn a_station_that_is_taken_is_waited_for() {
    let mut stage = Stage::new();
    stage.guide.go_to(&radians(B)).unwrap();
    let wrist = Point2::new(1.0, 1.73);
    let mut doing = Doing::Arrived;
    for _ in 0..40 {
        let (_, outlook, steps) = stage.step(&[trolley(wrist)]);
        assert!(matches!(outlook.reason, Some(Reason::NoPath(_))), "{outlook:?}");
        doing = steps[9].doing.clone();
        assert!(is_at(&stage.q, A));
    }
    assert!(matches!(doing, Doing::Waiting(Reason::NoPath(_))), "{doing:?}");
    (0..60).for_each(|_| _ = stage.step(&[]));
    assert!(is_at(&stage.q, B));
}

#[test]
fn a_watch_that_cannot_be_is_refused() {
    let arm = arm();
    let new = |camera: Calibration, settings: WatchSettings, step: f64| {
        Watch::new(Arc::clone(&arm), step, camera, seeing(), settings).unwrap_err()
    };
    let settings = WatchSettings::default();
    let step = 0.05;
    assert!(new(Calibration::Missing, settings, step).to_string().contains("calibrat"));
    let corners = [(-1.5, -2.4), (4.9, -2.4), (4.9, 2.4), (-1.5, 2.4)].map(|(x, y)| Point2::new(x, y));
    let pixels = [(0.0, 240.0), (320.0, 240.0), (320.0, 0.0), (0.0, 0.0)].map(|(x, y)| Point2::new(x, y));
    let floor = FloorHomography::from_points(320, 240, &pixels, &corners).unwrap();
    assert!(new(floor.into(), settings, step).to_string().contains("Camera::new"));
    let bad = WatchSettings { ahead_s: f64::NAN, ..settings };
    assert!(matches!(new(camera().into(), bad, step), WatchError::Setting { name: "ahead_s", .. }));
    assert!(matches!(new(camera().into(), settings, 1.0), WatchError::Fill(_)));
    assert!(matches!(new(camera().into(), settings, 0.0), WatchError::Grid(_)));
}

#[test]
fn a_watch_on_its_own_thread_tells_the_same_and_ends_cleanly() {
    let mut stage = Stage::new();
    let bytes = stage.shoot(&[trolley(Point2::new(1.9, 0.2))]);
    let mut reader = stage.watch.reader();
    let (t, q) = (stage.t, stage.q.clone());
    let Stage { watch, guide: mut moved, .. } = stage;
    let sentry = Sentry::post(watch).unwrap();
    let shot =
        |bytes: &[u8], stamp_s: f64| Shot { bytes: bytes.to_vec(), name: "camera.png".into(), stamp_s, q: q.clone() };
    assert!(sentry.send(shot(&bytes, t)));
    let mut told = Vec::new();
    for _ in 0..2000 {
        told.extend(sentry.told());
        if !told.is_empty() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let sighting = told.pop().unwrap().unwrap();
    assert!(sighting.is_clear() && sighting.prisms.len() == 1);
    assert_eq!(reader.latest().blocked(), sighting.blocked);
    moved.go_to(&radians(B)).unwrap();
    assert_eq!(moved.look(&sighting).reason, None);
    // Many at once: what is not taken is dropped, nothing waits.
    let taken = (0..20).filter(|n| sentry.send(shot(&bytes[..9], t + 1.0 + f64::from(*n)))).count();
    assert!((1..20).contains(&taken), "{taken}");
    let watch = sentry.stop().unwrap();
    assert_eq!(watch.map().table().blocked(), sighting.blocked);
    drop(Sentry::post(watch).unwrap());
}
