//! Routes in the exact scene: free, within limits, the ends that were asked for, and what is refused.

#[path = "common/robots.rs"]
mod robots;

use std::time::Duration;

use elbowroom_planner::{Connect, End, MotionLimits, Route, RouteError, RouteOptions, Trajectory};
use elbowroom_scene::{Checker, Level, Options, Scene, SceneError, SceneState, Selection, example};
use robots::{Random, cabinet, crane, halved, sheet, standing};

/// Nothing but exact geometry, at many points: what the planner never asks.
fn dense_check(scene: &Scene, state: &SceneState, robot: usize, path: &[Vec<f64>], points: usize) {
    let options = Options { level: Level::L3, weights: false, matrix: false, ..Options::default() };
    let (mut checker, mut state) = (Checker::new(scene, options), state.clone());
    let per_leg = points.div_ceil(path.len().max(2) - 1);
    for w in path.windows(2) {
        for n in 0..=per_leg {
            let t = n as f64 / per_leg as f64;
            let q: Vec<f64> = w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * t).collect();
            state.set_q(scene, robot, &q).unwrap();
            let hit = checker.between(Selection::Robot(robot), Selection::All).collides(&state);
            assert!(hit.is_none(), "{:?} at {q:?}", hit.map(|h| [h.a, h.b].map(|m| scene.name(m))));
            assert!(robots::within_limits(scene, robot, &q), "{q:?}");
        }
    }
}

fn limits(dof: usize) -> MotionLimits {
    MotionLimits { velocity: vec![2.0; dof], acceleration: vec![8.0; dof], jerk: vec![80.0; dof] }
}

/// Speeds and accelerations of the straight lines between rows.
fn check_rows(rows: &[(f64, Vec<f64>)], period: f64, limits: &MotionLimits) {
    let speed = |k: usize, i: usize| (rows[k + 1].1[i] - rows[k].1[i]) / period;
    for k in 0..rows.len() - 1 {
        for i in 0..limits.velocity.len() {
            assert!(speed(k, i).abs() <= limits.velocity[i] * (1.0 + 1e-9), "row {k}, joint {i}: {}", speed(k, i));
            if k > 0 {
                let acceleration = (speed(k, i) - speed(k - 1, i)) / period;
                assert!(
                    acceleration.abs() <= limits.acceleration[i] * (1.0 + 1e-6),
                    "row {k}, joint {i}: {acceleration}"
                );
            }
        }
    }
}

fn positions(rows: &[(f64, Vec<f64>)]) -> Vec<Vec<f64>> {
    rows.iter().map(|r| r.1.clone()).collect()
}

/// Plans, times, and checks everything that can be checked.
fn checked(
    scene: &Scene,
    robot: usize,
    state: &SceneState,
    goal: &[f64],
    options: &RouteOptions,
) -> Option<(Route, Trajectory)> {
    let mut connect = Connect::new(scene, robot).unwrap();
    let route = match connect.plan(state, goal, options) {
        Ok(route) => route,
        Err(RouteError::NotFound { .. } | RouteError::Contact { .. }) => return None,
        Err(e) => panic!("{e}"),
    };
    assert_eq!(route.waypoints[0], state.q(robot));
    assert_eq!(route.waypoints.last().unwrap(), goal);
    assert!(route.length_rad <= route.found_rad * (1.0 + 1e-9));
    dense_check(scene, state, robot, &route.waypoints, 400);
    let (period, limits) = (0.01, limits(goal.len()));
    let motion = connect.time(state, &route, &limits, period, options).unwrap();
    let rows = motion.rows(period).unwrap();
    check_rows(&rows, period, &limits);
    assert_eq!((&rows[0].1[..], &rows.last().unwrap().1[..]), (state.q(robot), goal));
    dense_check(scene, state, robot, &positions(&rows), 400.max(2 * rows.len()));
    Some((route, motion))
}

#[test]
fn routes_around_things_are_free_timed_and_end_where_they_should() {
    let (mut random, mut bent, mut found, mut stops) = (Random(5), 0, 0, 0);
    for scene in [example::two_arms(), cabinet(), crane()] {
        let options = RouteOptions { time_limit: Duration::from_secs(2), ..RouteOptions::default() };
        for _ in 0..12 {
            let (Some(from), Some(to)) = (random.free(&scene, 0), random.free(&scene, 0)) else { continue };
            let Some((route, motion)) = checked(&scene, 0, &standing(&scene, 0, &from), &to, &options) else {
                continue;
            };
            found += 1;
            bent += usize::from(route.waypoints.len() > 2);
            stops += motion.stops();
        }
    }
    println!("{found} found, {bent} bent, {stops} stops");
    assert!(found >= 20 && bent >= 8, "{found} {bent}");
}

#[test]
fn the_same_question_has_the_same_answer() {
    let scene = cabinet();
    let mut random = Random(9);
    let (from, to) = (random.free(&scene, 0).unwrap(), random.free(&scene, 0).unwrap());
    let state = standing(&scene, 0, &from);
    let plan = |seed| {
        let options = RouteOptions { seed, ..RouteOptions::default() };
        Connect::new(&scene, 0).unwrap().plan(&state, &to, &options).unwrap().waypoints
    };
    assert_eq!(plan(1), plan(1));
    // A planner that has planned before answers no different.
    let mut connect = Connect::new(&scene, 0).unwrap();
    let other = random.free(&scene, 0).unwrap();
    let _ = connect.plan(&state, &other, &RouteOptions::default());
    assert_eq!(connect.plan(&state, &to, &RouteOptions::default()).unwrap().waypoints, plan(1));
}

#[test]
fn a_clearance_is_kept() {
    let scene = example::two_arms();
    let from = [-0.9, 1.3, 0.6];
    let (state, goal) = (standing(&scene, 0, &from), [0.9, 1.3, 0.6]);
    let options = RouteOptions { clearance_m: 0.02, ..RouteOptions::default() };
    let (route, _) = checked(&scene, 0, &state, &goal, &options).expect("there is room");
    let (mut checker, mut state) = (Checker::new(&scene, Options::default()), state);
    for w in route.waypoints.windows(2) {
        for n in 0..=200 {
            let q: Vec<f64> = w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * f64::from(n) / 200.0).collect();
            state.set_q(&scene, 0, &q).unwrap();
            assert!(checker.distance(&state).unwrap().metres >= 0.02);
        }
    }
    for clearance_m in [f64::NAN, -0.1, f64::INFINITY] {
        let error = Connect::new(&scene, 0).unwrap().plan(&state, &goal, &RouteOptions { clearance_m, ..options });
        assert!(matches!(error, Err(RouteError::Option { .. })));
    }
    let error = Connect::new(&scene, 0).unwrap().plan(&state, &goal, &RouteOptions { clearance_m: 3.0, ..options });
    assert!(error.unwrap_err().to_string().contains("less than the clearance of 3 m"));
}

/// A random state that stands this near to something.
fn tight(scene: &Scene, random: &mut Random, range: std::ops::Range<f64>) -> Vec<f64> {
    let mut checker = Checker::new(scene, Options::default());
    loop {
        let q = random.free(scene, 0).unwrap();
        let near = checker.between(Selection::Robot(0), Selection::All).distance(&standing(scene, 0, &q)).unwrap();
        if range.contains(&near.metres) {
            return q;
        }
    }
}

#[test]
fn ends_that_stand_near_something_are_left_before_the_clearance_is_kept() {
    let scene = example::two_arms();
    let mut random = Random(11);
    let options = RouteOptions { clearance_m: 0.04, ..RouteOptions::default() };
    let mut checker = Checker::new(&scene, Options::default());
    for _ in 0..12 {
        let ends = [tight(&scene, &mut random, 0.001..0.015), tight(&scene, &mut random, 0.001..0.015)];
        let state = standing(&scene, 0, &ends[0]);
        let mut connect = Connect::new(&scene, 0).unwrap();
        assert!(matches!(connect.plan(&state, &ends[1], &options), Err(RouteError::Contact { .. })));
        let route = connect.plan_out(&state, &ends[1], &options).unwrap();
        let points = &route.waypoints;
        assert_eq!([&points[0], &points[points.len() - 1]], [&ends[0], &ends[1]]);
        let mut room = |q: &[f64]| {
            let all = checker.between(Selection::Robot(0), Selection::All);
            { all }.distance(&standing(&scene, 0, q)).unwrap().metres
        };
        let at_ends = [room(&ends[0]), room(&ends[1])];
        let legs = points.len() - 1;
        for (leg, w) in points.windows(2).enumerate() {
            let least = match leg {
                0 => 0.5 * at_ends[0],
                l if l + 1 == legs => 0.5 * at_ends[1],
                _ => 0.04,
            };
            for n in 0..=200 {
                let q: Vec<f64> = w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * f64::from(n) / 200.0).collect();
                assert!(room(&q) >= least, "leg {leg}: {} < {least}", room(&q));
            }
        }
        assert_eq!(connect.plan_out(&state, &ends[1], &options).unwrap().waypoints, route.waypoints);
    }
    // Where there is room at the ends nothing is different.
    let (from, to) = ([-0.9, 1.3, 0.6], [0.9, 1.3, 0.6]);
    let state = standing(&scene, 0, &from);
    let mut connect = Connect::new(&scene, 0).unwrap();
    let both = [connect.plan(&state, &to, &options).unwrap(), connect.plan_out(&state, &to, &options).unwrap()];
    assert_eq!(both[0].waypoints, both[1].waypoints);
}

#[test]
fn a_number_of_looks_ends_a_search_too() {
    let scene = halved();
    let options = RouteOptions { most_states: 500, time_limit: Duration::from_mins(10), ..RouteOptions::default() };
    let (here, there) = ([1.57, 1.0, 0.0], [-1.57, 1.0, 0.0]);
    let state = standing(&scene, 0, &here);
    let error = Connect::new(&scene, 0).unwrap().plan(&state, &there, &options).unwrap_err();
    let RouteError::NotFound { states, .. } = error else { panic!("{error}") };
    assert!((500..700).contains(&states), "{states}");
}

#[test]
fn what_is_locked_in_finds_no_way_and_says_that_this_proves_nothing() {
    let scene = halved();
    let options = RouteOptions { time_limit: Duration::from_millis(300), ..RouteOptions::default() };
    let (here, there) = ([1.57, 1.0, 0.0], [-1.57, 1.0, 0.0]);
    let state = standing(&scene, 0, &here);
    let error = Connect::new(&scene, 0).unwrap().plan(&state, &there, &options).unwrap_err();
    assert!(matches!(error, RouteError::NotFound { nodes, .. } if nodes >= 2), "{error}");
    assert!(error.to_string().contains("proves nothing"), "{error}");
    let none = RouteOptions { time_limit: Duration::ZERO, ..options };
    assert!(Connect::new(&scene, 0).unwrap().plan(&state, &there, &none).is_err());
    // Nothing to do is done, even with all the time in the world.
    let options = RouteOptions { time_limit: Duration::MAX, ..options };
    let route = Connect::new(&scene, 0).unwrap().plan(&state, &here, &options).unwrap();
    assert_eq!((route.waypoints.len(), route.length_rad), (2, 0.0));
}

#[test]
fn bad_ends_are_named() {
    let scene = example::two_arms();
    let mut connect = Connect::new(&scene, 0).unwrap();
    let (state, options) = (standing(&scene, 0, &[-0.9, 1.3, 0.6]), RouteOptions::default());
    let error = connect.plan(&state, &[0.0, 1.55, 0.6], &options).unwrap_err();
    let RouteError::Contact { end: End::Goal, a, b, metres, .. } = &error else { panic!("{error}") };
    assert!(a.starts_with("left/") && ["part", "table"].contains(&b.as_str()) && *metres == 0.0, "{error}");
    let error = connect.plan(&state, &[0.0, 100.0, 0.6], &options).unwrap_err();
    let RouteError::Beyond { end: End::Goal, joint, upper, .. } = &error else { panic!("{error}") };
    assert!(joint == "shoulder" && *upper == 2.2 && error.to_string().contains("degrees"), "{error}");
    let error = connect.plan(&standing(&scene, 0, &[0.0, 0.0, 2.6]), &[0.0; 3], &options).unwrap_err();
    assert!(matches!(error, RouteError::Beyond { end: End::Start, .. }), "{error}");
    let error = connect.plan(&state, &[0.0, f64::NAN, 0.0], &options).unwrap_err();
    assert!(matches!(error, RouteError::Scene(SceneError::JointNotFinite { .. })), "{error}");
    let error = connect.plan(&state, &[0.0, 0.0], &options).unwrap_err();
    assert!(matches!(error, RouteError::Scene(SceneError::JointCount { .. })), "{error}");
    assert!(matches!(Connect::new(&scene, 2), Err(SceneError::NoSuchRobot { .. })));
    let route = connect.plan(&state, &[-0.9, 1.0, 0.6], &options).unwrap();
    for period in [0.0, -1.0, f64::NAN] {
        assert!(connect.time(&state, &route, &limits(3), period, &options).is_err());
    }
    assert!(connect.time(&state, &route, &limits(2), 0.01, &options).is_err());
}

/// A sheet of paper stands in the way, far thinner than any distance between looks.
#[test]
fn nothing_is_too_thin_to_be_seen() {
    let (scene, mut bent) = (sheet(), 0);
    for turn in [0.4, 0.7, 1.1] {
        let (from, to) = ([-turn, 1.2, 0.3], [turn, 1.2, 0.3]);
        let Some((route, _)) = checked(&scene, 0, &standing(&scene, 0, &from), &to, &RouteOptions::default()) else {
            panic!("there is a way over the sheet");
        };
        dense_check(&scene, &standing(&scene, 0, &from), 0, &route.waypoints, 40_000);
        bent += usize::from(route.waypoints.len() > 2);
    }
    assert_eq!(bent, 3);
}

/// Somebody else's trouble is not ours: the other arm in the table does not keep this one from moving.
#[test]
fn pairs_without_the_robot_do_not_count() {
    let scene = example::two_arms();
    let mut state = standing(&scene, 0, &[2.5, 0.5, 0.5]);
    state.set_q(&scene, 1, &[3.1, 1.55, 0.6]).unwrap();
    assert!(Checker::new(&scene, Options::default()).collides(&state).is_some());
    checked(&scene, 0, &state, &[2.0, 0.3, 0.5], &RouteOptions::default()).expect("free to go");
}
