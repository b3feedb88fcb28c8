//! The executor alone, on a map that the tests change: it stops before blocked cells.

use crate::simulated_cell::{A, B, TICK_S, arm, limits, radians};
use elbowroom_cspace::{ConvexObstacle, JointMap, PlanarArm};
use elbowroom_perception::{
    ExactPathChecker, ExecutorError, ExecutorSettings, ExecutorState, ExecutorStep, HoldReason, ObstacleUpdate,
    PerceptionTimes, ReplanningExecutor,
};
use elbowroom_planner::GridPlannerError;
use elbowroom_spatial::{Pose, Vec3};
use elbowroom_vision::FrameStatus;
use proptest::prelude::*;

fn update(t: f64) -> ObstacleUpdate {
    ObstacleUpdate {
        stamp_s: t,
        status: FrameStatus::Accepted,
        prisms: vec![],
        entered: vec![],
        left: vec![],
        blocked: 0,
        freed: 0,
        times: PerceptionTimes::default(),
    }
}

fn map() -> JointMap {
    JointMap::new(PlanarArm::KR125, &arm().grid(3.0_f64.to_radians()).unwrap()).unwrap()
}

fn executor(map: &JointMap, settings: ExecutorSettings) -> ReplanningExecutor {
    ReplanningExecutor::new(arm(), map.grid(), map.reader(), None, settings, &radians(A)).unwrap()
}

/// A wall as high as the arm reaches, from the axis outward at an angle in the base.
fn wall(angle: f64) -> ConvexObstacle {
    let at = Vec3::new(1.8 * angle.cos(), 1.8 * angle.sin(), 1.5);
    ConvexObstacle::cuboid(Pose::from_xyz_rpy(at.to_array(), [0.0, 0.0, angle]), Vec3::new(1.3, 0.05, 1.6)).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    /// An impassable wall appears while the arm moves: from any state the arm stops in free cells where the distance
    /// suffices, and continues once the wall is removed.
    #[test]
    fn the_arm_stops_before_a_wall_and_continues_when_it_is_removed(angle in -0.6..0.9_f64, after in 1_u32..20) {
        let mut map = map();
        map.set_obstacle("behind", &wall(std::f64::consts::PI)); // otherwise the arm moves around the other side
        let mut executor = executor(&map, ExecutorSettings::new(limits()));
        executor.set_goal(&radians(B)).unwrap();
        let mut t = 0.0;
        let mut run = |executor: &mut ReplanningExecutor, map: &mut JointMap, frames: u32| -> Vec<ExecutorStep> {
            let mut steps = Vec::new();
            for _ in 0..frames {
                map.publish();
                executor.update(&update(t));
                steps.extend((0..10).map(|_| { t += TICK_S; executor.tick(t, TICK_S) }));
            }
            steps
        };
        run(&mut executor, &mut map, after);
        map.set_obstacle("wall", &wall(angle));
        let was_free = !map.is_blocked(executor.planar());
        let before = executor.planar();
        let mut blocked_after = false;
        for _ in 0..40 {
            for step in run(&mut executor, &mut map, 1) {
                blocked_after |= map.is_blocked(arm().to_planar(&step.q));
            }
        }
        let last = run(&mut executor, &mut map, 1).pop().unwrap();
        let is_stopped = last.qd == [0.0; 3];
        prop_assert!(is_stopped, "{last:?}");
        // From full speed it stops within 0.44 rad (1.75² / 2 / 3.5); a cell and 2° before the wall, and one frame
        // later, at most.
        let mut distance = 0.0;
        let mut q = before;
        while distance < 1.2 && !map.is_blocked(q) {
            distance += 0.01;
            q[0] += 0.01;
        }
        if was_free && distance > 0.7 {
            prop_assert!(!blocked_after, "the arm entered the wall with {distance} rad to stop");
        }
        if last.state != ExecutorState::Arrived {
            prop_assert!(matches!(last.state, ExecutorState::Waiting(HoldReason::Blocked | HoldReason::NoPath(_))), "{last:?}");
        }
        map.remove_obstacle("wall");
        let end = run(&mut executor, &mut map, 80).pop().unwrap();
        prop_assert!(end.q.iter().zip(radians(B)).all(|(a, b)| (a - b).abs() < 1e-9), "{end:?}");
    }
}

#[test]
fn a_new_goal_during_the_motion_stops_the_arm_first() {
    let mut map = map();
    let mut executor = executor(&map, ExecutorSettings::new(limits()));
    executor.set_goal(&radians(B)).unwrap();
    let mut t = 0.0;
    let mut steps = Vec::new();
    for frame in 0..120 {
        map.publish();
        executor.update(&update(t));
        if frame == 12 {
            executor.set_goal(&radians(A)).unwrap();
        }
        for _ in 0..10 {
            t += TICK_S;
            steps.push(executor.tick(t, TICK_S));
        }
    }
    assert!(steps.iter().any(|s| matches!(s.state, ExecutorState::Slowing(_))));
    let former_goal = radians(B);
    let is_there = |s: &ExecutorStep| s.q.iter().zip(&former_goal).all(|(a, b)| (a - b).abs() < 1e-3);
    assert!(!steps.iter().any(is_there), "the former goal was reached");
    let end = steps.last().unwrap();
    assert!(
        end.q.iter().zip(radians(A)).all(|(a, b)| (a - b).abs() < 1e-9) && end.state == ExecutorState::Arrived,
        "{end:?}"
    );
    let jump = steps.windows(2).map(|w| (w[1].q[0] - w[0].q[0]).abs()).fold(0.0, f64::max);
    assert!(jump < 1.76 * TICK_S, "{jump}");
}

#[test]
fn an_arm_in_a_blocked_cell_retreats_and_returns() {
    let mut map = map();
    let retreat = arm().to_planar(&radians([60.0, -120.0, 130.0, 0.0, 44.5, 0.0]));
    let settings = ExecutorSettings { retreat: Some(retreat), ..ExecutorSettings::new(limits()) };
    let exact = ExactPathChecker::new(arm(), Vec::new()).unwrap();
    let mut executor =
        ReplanningExecutor::new(arm(), map.grid(), map.reader(), Some(exact), settings, &radians(A)).unwrap();
    let mut t = 0.0;
    let mut run = |executor: &mut ReplanningExecutor, map: &mut JointMap, frames: u32| {
        for _ in 0..frames {
            map.publish();
            executor.update(&update(t));
            for _ in 0..10 {
                t += TICK_S;
                executor.tick(t, TICK_S);
            }
        }
    };
    executor.set_goal(&radians(A)).unwrap();
    run(&mut executor, &mut map, 3);
    let wrist = Vec3::new(1.0, -1.73, 0.5);
    map.set_obstacle("person", &ConvexObstacle::sphere(wrist, 0.2).unwrap());
    assert!(map.is_blocked(executor.planar()));
    run(&mut executor, &mut map, 60);
    assert!(!map.is_blocked(executor.planar()));
    map.remove_obstacle("person");
    run(&mut executor, &mut map, 80);
    let home = arm().to_planar(&radians(A));
    assert!((0..3).all(|i| (executor.planar()[i] - home[i]).abs() < 1e-9), "{:?}", executor.planar());
}

#[test]
fn an_image_with_a_future_stamp_is_rejected() {
    let map = map();
    let mut executor = executor(&map, ExecutorSettings::new(limits()));
    executor.set_goal(&radians(B)).unwrap();
    executor.update(&update(1.1));
    // Clocks may differ slightly …
    let mut t = 1.0;
    for _ in 0..50 {
        t += TICK_S;
        assert_eq!(executor.tick(t, TICK_S).state, ExecutorState::Moving);
    }
    // … but not by an hour: no image would ever be stale.
    executor.update(&update(t + 3600.0));
    let steps: Vec<ExecutorStep> = (0..250)
        .map(|_| {
            t += TICK_S;
            executor.tick(t, TICK_S)
        })
        .collect();
    assert!(
        matches!(steps[0].state, ExecutorState::Slowing(HoldReason::NoRecentImage { age_s }) if age_s < -3599.0),
        "{:?}",
        steps[0]
    );
    let last = steps.last().unwrap();
    assert!(
        matches!(last.state, ExecutorState::Waiting(HoldReason::NoRecentImage { .. })) && last.qd == [0.0; 3],
        "{last:?}"
    );
    assert!(last.state.reason().unwrap().to_string().contains("future"));
    executor.update(&update(t));
    assert_eq!(executor.tick(t + TICK_S, TICK_S).state, ExecutorState::Moving);
}

#[test]
fn a_tick_of_zero_duration_moves_nothing() {
    let mut map = map();
    map.set_obstacle("behind", &wall(std::f64::consts::PI));
    map.publish();
    for dt in [0.0, -0.0, -TICK_S, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for is_blocked in [false, true] {
            map.remove_obstacle("wall");
            map.publish();
            let mut executor = executor(&map, ExecutorSettings::new(limits()));
            executor.set_goal(&radians(B)).unwrap();
            executor.update(&update(0.0));
            (0..60).for_each(|_| _ = executor.tick(0.0, TICK_S));
            if is_blocked {
                map.set_obstacle("wall", &wall(0.0));
                map.publish();
                assert!(executor.update(&update(0.0)).was_blocked);
            }
            let before = executor.planar();
            let step = executor.tick(0.0, dt);
            assert!(executor.planar() == before && step.qd == [0.0; 3] && step.rate.to_bits() == 0, "{dt}: {step:?}");
            assert!(matches!(step.state, ExecutorState::Waiting(HoldReason::InvalidTimeStep { .. })), "{dt}: {step:?}");
            assert!(step.state.reason().unwrap().to_string().contains("seconds"));
            // The arm continues from rest.
            let next = executor.tick(0.0, TICK_S);
            assert!(next.rate < 0.1 && executor.planar().iter().all(|q| q.is_finite()), "{dt}: {next:?}");
        }
    }
}

#[test]
fn a_very_short_tick_is_computed_as_fast_as_any() {
    let mut map = map();
    map.set_obstacle("behind", &wall(std::f64::consts::PI));
    map.publish();
    let mut executor = executor(&map, ExecutorSettings::new(limits()));
    executor.set_goal(&radians(B)).unwrap();
    executor.update(&update(0.0));
    (0..60).for_each(|_| _ = executor.tick(0.0, TICK_S));
    map.set_obstacle("wall", &wall(0.0));
    map.publish();
    assert!(executor.update(&update(0.0)).was_blocked);
    let before = executor.planar();
    for dt in [1e-9, 1e-300, f64::MIN_POSITIVE] {
        executor.tick(0.0, dt);
    }
    assert!((0..3).all(|i| (executor.planar()[i] - before[i]).abs() < 1e-6));
}

#[test]
fn invalid_settings_and_goals_are_refused() {
    let map = map();
    let settings = ExecutorSettings::new(limits());
    let new = |settings: ExecutorSettings, q: &[f64]| {
        ReplanningExecutor::new(arm(), map.grid(), map.reader(), None, settings, q).map(|_| ()).unwrap_err()
    };
    let q = radians(A);
    assert_eq!(new(settings.clone(), &q[..4]), ExecutorError::Values { found: 4, dof: 6 });
    let outside = radians([0.0, 20.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(matches!(new(settings.clone(), &outside), ExecutorError::Plan(GridPlannerError::Outside { joint: 1, .. })));
    assert!(matches!(new(settings.clone(), &[f64::NAN; 6]), ExecutorError::Plan(GridPlannerError::Outside { .. })));
    let bad = ExecutorSettings { stale_s: f64::NAN, ..settings.clone() };
    assert!(matches!(new(bad, &q), ExecutorError::Setting { name: "stale_s", .. }));
    let bad = ExecutorSettings { stop: [1.0, -1.0, 1.0], ..settings.clone() };
    assert!(matches!(new(bad, &q), ExecutorError::Setting { name: "stop", .. }));
    let mut bad = settings.clone();
    bad.limits.jerk[2] = 0.0;
    assert!(matches!(new(bad, &q), ExecutorError::Limits(_)));
    let mut executor = ReplanningExecutor::new(arm(), map.grid(), map.reader(), None, settings, &q).unwrap();
    assert!(executor.set_goal(&outside).is_err() && executor.set_goal(&[]).is_err());
}

#[test]
fn a_clock_that_is_no_number_makes_every_image_stale() {
    let map = map();
    for at_rest in [true, false] {
        let mut executor = executor(&map, ExecutorSettings::new(limits()));
        executor.set_goal(&radians(B)).unwrap();
        executor.update(&update(0.0));
        if !at_rest {
            (0..20).for_each(|_| _ = executor.tick(0.0, TICK_S));
        }
        let steps: Vec<ExecutorStep> = (0..250).map(|_| executor.tick(f64::NAN, TICK_S)).collect();
        assert!(
            steps.iter().all(|step| matches!(step.state.reason(), Some(HoldReason::NoRecentImage { .. }))),
            "{:?}",
            steps[0]
        );
        assert_eq!(steps[249].qd, [0.0; 3]);
    }
}
