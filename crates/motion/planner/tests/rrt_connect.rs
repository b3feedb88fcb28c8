//! Paths in the exact scene: free, within limits, with the requested ends; and rejected input.

use crate::common::robots;
use elbowroom_kinematics::{JointLimits, TrajectoryRow};
use std::time::Duration;

use crate::common::robots::{Random, cabinet, crane, free_values, halved, sheet, state_at};
use elbowroom_planner::{BlendedTrajectory, JointPath, PathEnd, RrtConnect, RrtConnectError, RrtConnectSettings};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Checker, CheckerOptions, Level, Scene, SceneError, SceneState, Selection, example};

/// Collision queries at the finest level at many points, independent of the planner.
fn dense_check(scene: &Scene, state: &SceneState, robot: RobotId, path: &[Vec<f64>], points: usize) {
    let options = CheckerOptions { level: Level::L3, weights: false, matrix: false, ..CheckerOptions::default() };
    let (mut checker, mut state) = (Checker::new(scene, options), state.clone());
    let per_segment = points.div_ceil(path.len().max(2) - 1);
    for w in path.windows(2) {
        for n in 0..=per_segment {
            let t = n as f64 / per_segment as f64;
            let q: Vec<f64> = w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * t).collect();
            state.set_q(scene, robot, &q).unwrap();
            let hit = checker.between(Selection::Robot(robot), Selection::All).collides(&state);
            assert!(hit.is_none(), "{:?} at {q:?}", hit.map(|h| [h.a, h.b].map(|m| scene.name(m))));
            assert!(robots::within_limits(scene, robot, &q), "{q:?}");
        }
    }
}

fn limits(dof: usize) -> Vec<JointLimits> {
    vec![JointLimits::new(2.0, 8.0, 80.0); dof]
}

/// Checks speeds and accelerations of the straight lines between samples.
fn check_samples(samples: &[TrajectoryRow], period: f64, limits: &[JointLimits]) {
    let speed = |k: usize, i: usize| (samples[k + 1].q[i] - samples[k].q[i]) / period;
    for k in 0..samples.len() - 1 {
        for i in 0..limits.len() {
            assert!(speed(k, i).abs() <= limits[i].velocity * (1.0 + 1e-9), "sample {k}, joint {i}: {}", speed(k, i));
            if k > 0 {
                let acceleration = (speed(k, i) - speed(k - 1, i)) / period;
                assert!(
                    acceleration.abs() <= limits[i].acceleration * (1.0 + 1e-6),
                    "sample {k}, joint {i}: {acceleration}"
                );
            }
        }
    }
}

/// Plans, computes a trajectory, and checks both.
fn checked(
    scene: &Scene,
    robot: RobotId,
    state: &SceneState,
    goal: &[f64],
    settings: &RrtConnectSettings,
) -> Option<(JointPath, BlendedTrajectory)> {
    let mut planner = RrtConnect::new(scene, robot).unwrap();
    let path = match planner.plan(state, goal, settings) {
        Ok(path) => path,
        Err(RrtConnectError::NotFound { .. } | RrtConnectError::InCollision { .. }) => return None,
        Err(e) => panic!("{e}"),
    };
    assert_eq!(path.waypoints[0], state.q(robot));
    assert_eq!(path.waypoints.last().unwrap(), goal);
    assert!(path.length_rad <= path.raw_length_rad * (1.0 + 1e-9));
    dense_check(scene, state, robot, &path.waypoints, 400);
    let (period, limits) = (0.01, limits(goal.len()));
    let trajectory = planner.time_parametrize(state, &path, &limits, period, settings).unwrap();
    let samples = trajectory.samples(period).unwrap();
    check_samples(samples.rows(), period, &limits);
    assert_eq!((samples.first(), samples.last()), (Some(state.q(robot)), Some(goal)));
    let positions: Vec<_> = samples.rows().iter().map(|row| row.q.clone()).collect();
    dense_check(scene, state, robot, &positions, 400.max(2 * positions.len()));
    Some((path, trajectory))
}

#[test]
fn paths_and_trajectories_are_free_and_have_the_requested_ends() {
    let (mut random, mut bent, mut found, mut stops) = (Random(5), 0, 0, 0);
    for scene in [example::two_arms(), cabinet(), crane()] {
        let settings = RrtConnectSettings { time_limit: Duration::from_secs(2), ..RrtConnectSettings::default() };
        for _ in 0..12 {
            let (Some(from), Some(to)) =
                (free_values(&mut random, &scene, RobotId(0)), free_values(&mut random, &scene, RobotId(0)))
            else {
                continue;
            };
            let Some((path, trajectory)) =
                checked(&scene, RobotId(0), &state_at(&scene, RobotId(0), &from), &to, &settings)
            else {
                continue;
            };
            found += 1;
            bent += usize::from(path.waypoints.len() > 2);
            stops += trajectory.stops();
        }
    }
    println!("{found} found, {bent} bent, {stops} stops");
    assert!(found >= 20 && bent >= 8, "{found} {bent}");
}

#[test]
fn planning_is_reproducible() {
    let scene = cabinet();
    let mut random = Random(9);
    let (from, to) =
        (free_values(&mut random, &scene, RobotId(0)).unwrap(), free_values(&mut random, &scene, RobotId(0)).unwrap());
    let state = state_at(&scene, RobotId(0), &from);
    let plan = |seed| {
        let settings = RrtConnectSettings { seed, ..RrtConnectSettings::default() };
        RrtConnect::new(&scene, RobotId(0)).unwrap().plan(&state, &to, &settings).unwrap().waypoints
    };
    assert_eq!(plan(1), plan(1));
    // Earlier queries do not affect a planner.
    let mut planner = RrtConnect::new(&scene, RobotId(0)).unwrap();
    let other = free_values(&mut random, &scene, RobotId(0)).unwrap();
    let _ = planner.plan(&state, &other, &RrtConnectSettings::default());
    assert_eq!(planner.plan(&state, &to, &RrtConnectSettings::default()).unwrap().waypoints, plan(1));
}

#[test]
fn a_clearance_is_kept() {
    let scene = example::two_arms();
    let from = [-0.9, 1.3, 0.6];
    let (state, goal) = (state_at(&scene, RobotId(0), &from), [0.9, 1.3, 0.6]);
    let settings = RrtConnectSettings { clearance_m: 0.02, ..RrtConnectSettings::default() };
    let (path, _) = checked(&scene, RobotId(0), &state, &goal, &settings).expect("there is such a path");
    let (mut checker, mut state) = (Checker::new(&scene, CheckerOptions::default()), state);
    for w in path.waypoints.windows(2) {
        for n in 0..=200 {
            let q: Vec<f64> = w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * f64::from(n) / 200.0).collect();
            state.set_q(&scene, RobotId(0), &q).unwrap();
            assert!(checker.distance(&state).unwrap().metres >= 0.02);
        }
    }
    for clearance_m in [f64::NAN, -0.1, f64::INFINITY] {
        let error = RrtConnect::new(&scene, RobotId(0)).unwrap().plan(
            &state,
            &goal,
            &RrtConnectSettings { clearance_m, ..settings },
        );
        assert!(matches!(error, Err(RrtConnectError::InvalidSetting { .. })));
    }
    let error = RrtConnect::new(&scene, RobotId(0)).unwrap().plan(
        &state,
        &goal,
        &RrtConnectSettings { clearance_m: 3.0, ..settings },
    );
    assert!(error.unwrap_err().to_string().contains("less than the clearance of 3 m"));
}

/// A random free configuration within a range of distances.
fn at_distance(scene: &Scene, random: &mut Random, range: std::ops::Range<f64>) -> Vec<f64> {
    let mut checker = Checker::new(scene, CheckerOptions::default());
    loop {
        let q = free_values(random, scene, RobotId(0)).unwrap();
        let near = checker
            .between(Selection::Robot(RobotId(0)), Selection::All)
            .distance(&state_at(scene, RobotId(0), &q))
            .unwrap();
        if range.contains(&near.metres) {
            return q;
        }
    }
}

#[test]
fn tight_ends_are_left_before_the_clearance_is_kept() {
    let scene = example::two_arms();
    let mut random = Random(11);
    let settings = RrtConnectSettings { clearance_m: 0.04, ..RrtConnectSettings::default() };
    let mut checker = Checker::new(&scene, CheckerOptions::default());
    for _ in 0..12 {
        let ends = [at_distance(&scene, &mut random, 0.001..0.015), at_distance(&scene, &mut random, 0.001..0.015)];
        let state = state_at(&scene, RobotId(0), &ends[0]);
        let mut planner = RrtConnect::new(&scene, RobotId(0)).unwrap();
        assert!(matches!(planner.plan(&state, &ends[1], &settings), Err(RrtConnectError::InCollision { .. })));
        let path = planner.plan_from_tight_ends(&state, &ends[1], &settings).unwrap();
        let points = &path.waypoints;
        assert_eq!([&points[0], &points[points.len() - 1]], [&ends[0], &ends[1]]);
        let mut distance = |q: &[f64]| {
            let all = checker.between(Selection::Robot(RobotId(0)), Selection::All);
            { all }.distance(&state_at(&scene, RobotId(0), q)).unwrap().metres
        };
        let at_ends = [distance(&ends[0]), distance(&ends[1])];
        let segments = points.len() - 1;
        for (segment, w) in points.windows(2).enumerate() {
            let least = match segment {
                0 => 0.5 * at_ends[0],
                l if l + 1 == segments => 0.5 * at_ends[1],
                _ => 0.04,
            };
            for n in 0..=200 {
                let q: Vec<f64> = w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * f64::from(n) / 200.0).collect();
                assert!(distance(&q) >= least, "segment {segment}: {} < {least}", distance(&q));
            }
        }
        assert_eq!(planner.plan_from_tight_ends(&state, &ends[1], &settings).unwrap().waypoints, path.waypoints);
    }
    // With the clearance at the ends, both methods agree.
    let (from, to) = ([-0.9, 1.3, 0.6], [0.9, 1.3, 0.6]);
    let state = state_at(&scene, RobotId(0), &from);
    let mut planner = RrtConnect::new(&scene, RobotId(0)).unwrap();
    let both =
        [planner.plan(&state, &to, &settings).unwrap(), planner.plan_from_tight_ends(&state, &to, &settings).unwrap()];
    assert_eq!(both[0].waypoints, both[1].waypoints);
}

#[test]
fn the_number_of_states_is_limited() {
    let scene = halved();
    let settings =
        RrtConnectSettings { max_states: 500, time_limit: Duration::from_mins(10), ..RrtConnectSettings::default() };
    let (here, there) = ([1.57, 1.0, 0.0], [-1.57, 1.0, 0.0]);
    let state = state_at(&scene, RobotId(0), &here);
    let error = RrtConnect::new(&scene, RobotId(0)).unwrap().plan(&state, &there, &settings).unwrap_err();
    let RrtConnectError::NotFound { states_checked, .. } = error else { panic!("{error}") };
    assert!((500..700).contains(&states_checked), "{states_checked}");
    // Of several goals the whole effort is told.
    let goals = [there, [-1.5, 1.0, 0.1], [-1.5, 0.9, 0.0]];
    let error = RrtConnect::new(&scene, RobotId(0)).unwrap().plan_to_any(&state, &goals, &settings).unwrap_err();
    let RrtConnectError::NotFound { states_checked, nodes, .. } = error else { panic!("{error}") };
    assert!((1500..2100).contains(&states_checked) && nodes >= 6, "{states_checked}, {nodes}");
}

#[test]
fn a_missing_path_is_reported_as_not_found() {
    let scene = halved();
    let settings = RrtConnectSettings { time_limit: Duration::from_millis(300), ..RrtConnectSettings::default() };
    let (here, there) = ([1.57, 1.0, 0.0], [-1.57, 1.0, 0.0]);
    let state = state_at(&scene, RobotId(0), &here);
    let error = RrtConnect::new(&scene, RobotId(0)).unwrap().plan(&state, &there, &settings).unwrap_err();
    assert!(matches!(error, RrtConnectError::NotFound { nodes, .. } if nodes >= 2), "{error}");
    assert!(error.to_string().contains("proves nothing"), "{error}");
    let none = RrtConnectSettings { time_limit: Duration::ZERO, ..settings };
    assert!(RrtConnect::new(&scene, RobotId(0)).unwrap().plan(&state, &there, &none).is_err());
    // Start and goal are equal, and the time limit is the longest duration.
    let settings = RrtConnectSettings { time_limit: Duration::MAX, ..settings };
    let path = RrtConnect::new(&scene, RobotId(0)).unwrap().plan(&state, &here, &settings).unwrap();
    assert_eq!((path.waypoints.len(), path.length_rad), (2, 0.0));
}

#[test]
fn invalid_ends_are_reported() {
    let scene = example::two_arms();
    let mut planner = RrtConnect::new(&scene, RobotId(0)).unwrap();
    let (state, settings) = (state_at(&scene, RobotId(0), &[-0.9, 1.3, 0.6]), RrtConnectSettings::default());
    let error = planner.plan(&state, &[0.0, 1.55, 0.6], &settings).unwrap_err();
    let RrtConnectError::InCollision { end: PathEnd::Goal, a, b, metres, .. } = &error else { panic!("{error}") };
    assert!(a.starts_with("left/") && ["part", "table"].contains(&b.as_str()) && *metres == 0.0, "{error}");
    let error = planner.plan(&state, &[0.0, 100.0, 0.6], &settings).unwrap_err();
    let RrtConnectError::OutOfLimits { end: PathEnd::Goal, joint, upper, .. } = &error else { panic!("{error}") };
    assert!(joint == "shoulder" && *upper == 2.2 && error.to_string().contains("degrees"), "{error}");
    let error = planner.plan(&state_at(&scene, RobotId(0), &[0.0, 0.0, 2.6]), &[0.0; 3], &settings).unwrap_err();
    assert!(matches!(error, RrtConnectError::OutOfLimits { end: PathEnd::Start, .. }), "{error}");
    let error = planner.plan(&state, &[0.0, f64::NAN, 0.0], &settings).unwrap_err();
    assert!(matches!(error, RrtConnectError::Scene(SceneError::JointNotFinite { .. })), "{error}");
    let error = planner.plan(&state, &[0.0, 0.0], &settings).unwrap_err();
    assert!(matches!(error, RrtConnectError::Scene(SceneError::JointCount { .. })), "{error}");
    assert!(matches!(RrtConnect::new(&scene, RobotId(2)), Err(SceneError::NoSuchRobot { .. })));
    let path = planner.plan(&state, &[-0.9, 1.0, 0.6], &settings).unwrap();
    for period in [0.0, -1.0, f64::NAN] {
        assert!(planner.time_parametrize(&state, &path, &limits(3), period, &settings).is_err());
    }
    assert!(planner.time_parametrize(&state, &path, &limits(2), 0.01, &settings).is_err());
}

/// A sheet far thinner than the check resolution is between start and goal.
#[test]
fn thin_obstacles_are_found() {
    let (scene, mut bent) = (sheet(), 0);
    for turn in [0.4, 0.7, 1.1] {
        let (from, to) = ([-turn, 1.2, 0.3], [turn, 1.2, 0.3]);
        let Some((path, _)) =
            checked(&scene, RobotId(0), &state_at(&scene, RobotId(0), &from), &to, &RrtConnectSettings::default())
        else {
            panic!("there is a path over the sheet");
        };
        dense_check(&scene, &state_at(&scene, RobotId(0), &from), RobotId(0), &path.waypoints, 40_000);
        bent += usize::from(path.waypoints.len() > 2);
    }
    assert_eq!(bent, 3);
}

/// The other arm collides with the table, which does not affect planning for this arm.
#[test]
fn pairs_without_the_robot_do_not_count() {
    let scene = example::two_arms();
    let mut state = state_at(&scene, RobotId(0), &[2.5, 0.5, 0.5]);
    state.set_q(&scene, RobotId(1), &[3.1, 1.55, 0.6]).unwrap();
    assert!(Checker::new(&scene, CheckerOptions::default()).collides(&state).is_some());
    checked(&scene, RobotId(0), &state, &[2.0, 0.3, 0.5], &RrtConnectSettings::default()).expect("a free path");
}
