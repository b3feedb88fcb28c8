//! Perception and replanning: the arm moves around obstacles, and stops safely without images.

use std::path::Path;
use std::sync::Arc;

use crate::simulated_cell::{A, B, PERIOD_S, SimulatedCell, TICK_S, arm, camera, limits, radians, tracker_settings};
use elbowroom_perception::{
    CapturedImage, ExecutorState, ExecutorStep, HoldReason, PerceptionError, PerceptionPipeline, PerceptionSettings,
    PerceptionWorker,
};
use elbowroom_proximity::{Cuboid, Shape, ccd::ConstantTwist};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Checker, CheckerOptions, Object, Scene, SceneState, SweepMove, SweepOptions};
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_vision::render::RenderedSolid;
use elbowroom_vision::{Calibration, FloorHomography, FrameStatus, Point2, encode_png};

const SIZE: Vec3 = Vec3::new(0.5, 0.5, 1.5);

fn trolley(at: Point2) -> RenderedSolid {
    RenderedSolid::cuboid(at, SIZE, 0.0, 215)
}

fn is_at(q: &[f64], goal: [f64; 6]) -> bool {
    q.iter().zip(radians(goal)).all(|(a, b)| (a - b).abs() < 1e-9)
}

/// Checks joint steps, velocities and accelerations of consecutive ticks.
fn check_motion(steps: &[ExecutorStep]) {
    let most = limits();
    for w in steps.windows(2) {
        for i in 0..3 {
            let moved = (w[1].q[i] - w[0].q[i]).abs();
            assert!(moved <= most.velocity[i] * TICK_S * 1.01, "jump of {moved} rad");
            let change = (w[1].qd[i] - w[0].qd[i]).abs() / TICK_S;
            // Up to 15 % more where a stop is added to a corner at the limit.
            assert!(change <= most.acceleration[i] * 1.15, "joint {i}: {change} rad/s²");
        }
    }
}

#[test]
fn the_arm_moves_around_crossing_obstacles_without_collision() {
    let mut cell = SimulatedCell::new();
    let shape = Shape::Cuboid(Cuboid { half_extents: SIZE * 0.5 });
    let pose = |t: f64| Pose::from_translation(Vec3::new(1.9, -2.0 + 0.45 * (t - 1.2), 0.75));
    let mut builder = Scene::builder();
    builder.robot("kr125", cell.arm.robot.clone(), Pose::IDENTITY);
    builder.object(Object { name: "trolley".into(), shape, in_world: pose(1.2) });
    let scene = builder.build().unwrap();
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    let mut state = SceneState::new(&scene);
    state.set_q(&scene, RobotId(0), &cell.q).unwrap();
    let (mut next, mut arrivals, mut in_motion, mut all) = (B, 0, 0, Vec::new());
    cell.executor.set_goal(&radians(next)).unwrap();
    for _ in 0..220 {
        let from = cell.t;
        let at = pose(from).translation;
        let (update, result, steps) = cell.step(&[trolley(Point2::new(at.x, at.y))]);
        assert!(update.is_accepted());
        in_motion += usize::from(result.in_motion);
        for (n, step) in steps.iter().enumerate() {
            let t = from + TICK_S * n as f64;
            let path = ConstantTwist::linear(pose(t), pose(t + TICK_S).translation - pose(t).translation);
            let moves = [
                SweepMove::Robot { robot: RobotId(0), to: &step.q },
                SweepMove::Object { object: ObjectId(0), path: &path },
            ];
            let hit = checker.sweep(&state, &moves, &SweepOptions::default()).unwrap();
            assert_eq!(hit, None, "at {t}");
            state.set_q(&scene, RobotId(0), &step.q).unwrap();
        }
        let has_arrived = is_at(&cell.q, next);
        all.extend(steps);
        if has_arrived {
            (next, arrivals) = (if next == B { A } else { B }, arrivals + 1);
            cell.executor.set_goal(&radians(next)).unwrap();
        }
    }
    check_motion(&all);
    assert!(arrivals >= 2 && in_motion >= 3, "{arrivals} stations, {in_motion} changes while moving");
}

#[test]
fn without_images_the_arm_stops_with_a_reason_and_continues_when_they_return() {
    let mut cell = SimulatedCell::new();
    cell.executor.set_goal(&radians(B)).unwrap();
    let mut all: Vec<ExecutorStep> = (0..15).flat_map(|_| cell.step(&[]).2).collect();
    assert_eq!(all.last().unwrap().state, ExecutorState::Moving);
    let without_images: Vec<ExecutorStep> = (0..40).flat_map(|_| cell.ticks()).collect();
    let first = without_images.iter().position(|s| matches!(s.state, ExecutorState::Slowing(_))).unwrap();
    // 150 ms after the stamp of the last image.
    let silent_s = TICK_S * (first as f64 + 1.0) + PERIOD_S;
    assert!((0.15..0.16).contains(&silent_s), "{silent_s}");
    let stopped = without_images.last().unwrap();
    assert!(
        matches!(&stopped.state, ExecutorState::Waiting(HoldReason::NoRecentImage { age_s }) if *age_s > 1.0),
        "{:?}",
        stopped.state
    );
    assert!(stopped.qd == [0.0; 3] && !is_at(&stopped.q, B));
    all.extend(without_images);
    all.extend((0..60).flat_map(|_| cell.step(&[]).2));
    assert!(is_at(&all.last().unwrap().q, B), "{:?}", all.last());
    check_motion(&all);
}

#[test]
fn rejected_frames_have_a_reason_and_free_no_cells() {
    let mut cell = SimulatedCell::new();
    let here = [trolley(Point2::new(1.9, 0.0))];
    let (update, ..) = cell.step(&here);
    let blocked = cell.pipeline.map().occupancy().blocked();
    assert!(blocked > 0 && update.entered.len() == 1 && update.blocked == blocked);
    let good = cell.render_image(&[]);
    let small = {
        let mut frame = elbowroom_vision::Frame::default();
        frame.fill(8, 6, elbowroom_vision::Channels::Grey, |bytes| bytes.resize(48, 7)).unwrap();
        encode_png(&frame).unwrap()
    };
    let q = cell.q.clone();
    let mut process = |bytes: &[u8], t: f64, q: &[f64]| {
        let error = cell.pipeline.process_image(bytes, Path::new("camera.png"), t, q).unwrap_err();
        assert_eq!(cell.pipeline.map().occupancy().blocked(), blocked, "{error}");
        error.to_string()
    };
    let t = 10.0;
    assert!(process(&[], t, &q).contains("is empty"));
    assert!(process(&good[..good.len() / 2], t, &q).contains("cannot be decoded"));
    assert!(process(b"no picture at all", t, &q).contains("PNG"));
    assert!(process(&small, t, &q).contains("320"));
    assert!(process(&good, 0.1, &q).contains("camera.png"));
    assert!(process(&good, f64::NAN, &q).contains("NaN"));
    assert!(process(&good, t, &q[..5]).contains("5 joint values"));
    assert!(process(&good, t, &[f64::NAN; 6]).contains("finite"));
    // A valid frame afterwards is accepted.
    assert!(cell.pipeline.process_image(&good, Path::new("camera.png"), t, &q).unwrap().is_accepted());
}

#[test]
fn rejected_frames_stop_the_arm() {
    let mut cell = SimulatedCell::new();
    cell.executor.set_goal(&radians(B)).unwrap();
    (0..10).for_each(|_| _ = cell.step(&[]));
    let mut last = None;
    for _ in 0..25 {
        cell.render_image(&[]);
        cell.frame.pixels_mut().fill(255);
        let bytes = encode_png(&cell.frame).unwrap();
        let update = cell.send(&bytes).unwrap();
        assert!(matches!(update.status, FrameStatus::Rejected(_)));
        cell.executor.update(&update);
        last = cell.ticks().pop();
    }
    assert!(matches!(last.unwrap().state, ExecutorState::Waiting(HoldReason::NoRecentImage { .. })));
}

#[test]
fn a_robot_waits_for_an_occupied_station() {
    let mut cell = SimulatedCell::new();
    cell.executor.set_goal(&radians(B)).unwrap();
    let wrist = Point2::new(1.0, 1.73);
    let mut state = ExecutorState::Arrived;
    for _ in 0..40 {
        let (_, result, steps) = cell.step(&[trolley(wrist)]);
        assert!(matches!(result.reason, Some(HoldReason::NoPath(_))), "{result:?}");
        state = steps[9].state.clone();
        assert!(is_at(&cell.q, A));
    }
    assert!(matches!(state, ExecutorState::Waiting(HoldReason::NoPath(_))), "{state:?}");
    (0..60).for_each(|_| _ = cell.step(&[]));
    assert!(is_at(&cell.q, B));
}

#[test]
fn a_pipeline_with_invalid_settings_is_refused() {
    let arm = arm();
    let new = |camera: Calibration, settings: PerceptionSettings, step: f64| {
        PerceptionPipeline::new(Arc::clone(&arm), step, camera, tracker_settings(), settings).unwrap_err()
    };
    let settings = PerceptionSettings::default();
    let step = 0.05;
    assert!(new(Calibration::Missing, settings, step).to_string().contains("calibrat"));
    let corners = [(-1.5, -2.4), (4.9, -2.4), (4.9, 2.4), (-1.5, 2.4)].map(|(x, y)| Point2::new(x, y));
    let pixels = [(0.0, 240.0), (320.0, 240.0), (320.0, 0.0), (0.0, 0.0)].map(|(x, y)| Point2::new(x, y));
    let floor = FloorHomography::from_points(320, 240, &pixels, &corners).unwrap();
    assert!(new(floor.into(), settings, step).to_string().contains("Camera::new"));
    let bad = PerceptionSettings { prediction_s: f64::NAN, ..settings };
    assert!(matches!(new(camera().into(), bad, step), PerceptionError::Setting { name: "prediction_s", .. }));
    assert!(matches!(new(camera().into(), settings, 1.0), PerceptionError::Fill(_)));
    assert!(matches!(new(camera().into(), settings, 0.0), PerceptionError::Grid(_)));
}

#[test]
fn a_pipeline_on_its_own_thread_reports_the_same_and_ends_cleanly() {
    let mut cell = SimulatedCell::new();
    let bytes = cell.render_image(&[trolley(Point2::new(1.9, 0.2))]);
    let mut reader = cell.pipeline.reader();
    let (t, q) = (cell.t, cell.q.clone());
    let SimulatedCell { pipeline, executor: mut moved, .. } = cell;
    let worker = PerceptionWorker::spawn(pipeline).unwrap();
    let image = |bytes: &[u8], stamp_s: f64| CapturedImage {
        bytes: bytes.to_vec(),
        name: "camera.png".into(),
        stamp_s,
        q: q.clone(),
    };
    assert!(worker.send(image(&bytes, t)));
    let mut updates = Vec::new();
    for _ in 0..2000 {
        updates.extend(worker.updates());
        if !updates.is_empty() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    let update = updates.pop().unwrap().unwrap();
    assert!(update.is_accepted() && update.prisms.len() == 1);
    assert_eq!(reader.latest().blocked(), update.blocked);
    moved.set_goal(&radians(B)).unwrap();
    assert_eq!(moved.update(&update).reason, None);
    // Many at once: frames that are not accepted are dropped, and nothing blocks.
    let mut sent = (0..10_000).map(|n| worker.send(image(&bytes[..9], t + 1.0 + f64::from(n))));
    assert!(sent.any(|is_taken| is_taken) && sent.any(|is_taken| !is_taken));
    let pipeline = worker.stop().unwrap();
    assert_eq!(pipeline.map().occupancy().blocked(), update.blocked);
    drop(PerceptionWorker::spawn(pipeline).unwrap());
}
