//! Paths under a constraint in joint space, checked at many of their points.

use elbowroom_kinematics::JointLimits;
use std::time::Duration;

use crate::common::robots::{Random, cabinet, crane, free_values, state_at};
use elbowroom_planner::{JointPath, PathConstraint, PathEnd, RrtConnect, RrtConnectError, RrtConnectSettings};
use elbowroom_robot::RobotId;
use elbowroom_scene::{Scene, SceneState, example};

/// Forbids configurations within `radius` of a point, or of a disc perpendicular to the first value.
#[derive(Debug, Clone)]
struct Forbidden {
    center: Vec<f64>,
    radius: f64,
    /// Radius of the disc; 0 for a ball.
    disc: f64,
    /// Margin that paths keep.
    margin: f64,
}

impl Forbidden {
    fn ball(center: &[f64], radius: f64) -> Self {
        Self { center: center.to_vec(), radius, disc: 0.0, margin: 0.02 }
    }

    fn distance(&self, q: &[f64]) -> f64 {
        let off: Vec<f64> = q.iter().zip(&self.center).map(|(q, c)| q - c).collect();
        let along = off[1..].iter().map(|d| d * d).sum::<f64>().sqrt();
        off[0].hypot((along - self.disc).max(0.0)) - self.radius
    }
}

impl PathConstraint for Forbidden {
    fn distance_m(&mut self, q: &[f64], _limit_m: f64) -> f64 {
        self.distance(q)
    }

    fn margin_m(&mut self, q: &[f64], _limit_m: f64) -> f64 {
        self.distance(q) - self.margin
    }

    fn motion_bound_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
        from.iter().zip(to).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    fn describe_nearest(&mut self, _q: &[f64]) -> String {
        "the ball".into()
    }
}

/// A constraint with a constant distance.
#[derive(Debug)]
struct Everywhere(f64);

impl PathConstraint for Everywhere {
    fn distance_m(&mut self, _q: &[f64], _limit_m: f64) -> f64 {
        self.0
    }

    fn motion_bound_m(&mut self, _from: &[f64], _to: &[f64]) -> f64 {
        1.0
    }

    fn describe_nearest(&mut self, _q: &[f64]) -> String {
        "everything".into()
    }
}

fn settings() -> RrtConnectSettings {
    RrtConnectSettings { time_limit: Duration::from_secs(2), ..RrtConnectSettings::default() }
}

fn plan(
    scene: &Scene,
    state: &SceneState,
    goal: &[f64],
    constraint: impl PathConstraint,
) -> Result<JointPath, RrtConnectError> {
    RrtConnect::new(scene, RobotId(0)).unwrap().with_constraint(constraint).plan(state, goal, &settings())
}

/// The least distance at many points of a polyline.
fn least(constraint: &Forbidden, path: &[Vec<f64>], points: usize) -> f64 {
    let mut least = f64::INFINITY;
    for w in path.windows(2) {
        for n in 0..=points {
            let t = n as f64 / points as f64;
            let q: Vec<f64> = w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * t).collect();
            least = least.min(constraint.distance(&q));
        }
    }
    least
}

fn middle(path: &[Vec<f64>]) -> Vec<f64> {
    let long = |w: &&[Vec<f64>]| w[0].iter().zip(&w[1]).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let segment = path.windows(2).max_by(|a, b| long(a).total_cmp(&long(b))).unwrap();
    segment[0].iter().zip(&segment[1]).map(|(a, b)| 0.5 * (a + b)).collect()
}

#[test]
fn paths_and_trajectories_satisfy_the_constraint() {
    let (mut random, mut found, mut asked) = (Random(3), 0, 0);
    for scene in [example::two_arms(), cabinet(), crane()] {
        for _ in 0..8 {
            let (Some(from), Some(to)) =
                (free_values(&mut random, &scene, RobotId(0)), free_values(&mut random, &scene, RobotId(0)))
            else {
                continue;
            };
            let state = state_at(&scene, RobotId(0), &from);
            let Ok(bare) = RrtConnect::new(&scene, RobotId(0)).unwrap().plan(&state, &to, &settings()) else {
                continue;
            };
            let constraint = Forbidden::ball(&middle(&bare.waypoints), 0.4);
            if constraint.distance(&from).min(constraint.distance(&to)) < 0.05 {
                continue;
            }
            assert!(least(&constraint, &bare.waypoints, 500) < -0.3);
            asked += 1;
            let mut planner = RrtConnect::new(&scene, RobotId(0)).unwrap().with_constraint(constraint.clone());
            let path = match planner.plan(&state, &to, &settings()) {
                Err(RrtConnectError::NotFound { .. }) => continue,
                other => other.unwrap(),
            };
            found += 1;
            assert_eq!((&path.waypoints[0], &path.waypoints[path.waypoints.len() - 1]), (&from, &to));
            assert!(least(&constraint, &path.waypoints, 5_000) > constraint.margin);
            let dof = to.len();
            let limits = vec![JointLimits::new(2.0, 8.0, 80.0); dof];
            let trajectory = planner.time_parametrize(&state, &path, &limits, 0.01, &settings()).unwrap();
            let samples: Vec<_> = trajectory.samples(0.01).unwrap().rows().iter().map(|row| row.q.clone()).collect();
            assert!(least(&constraint, &samples, 20) > constraint.margin);
        }
    }
    println!("{found} of {asked}");
    assert!(found >= 12 && found * 10 >= asked * 7, "{found} of {asked}");
}

/// The disc is far thinner than the check resolution; the path leads around its rim.
#[test]
fn thin_violations_are_found() {
    let scene = example::two_arms();
    for turn in [0.3, 0.5, 0.8] {
        let (from, to) = ([1.6 - turn, 0.3, 0.4], [1.6 + turn, 0.3, 0.4]);
        let disc = Forbidden { center: vec![1.6, 0.3, 0.4], radius: 1e-7, disc: 0.6, margin: 0.0 };
        let state = state_at(&scene, RobotId(0), &from);
        let bare = RrtConnect::new(&scene, RobotId(0)).unwrap().plan(&state, &to, &settings()).unwrap();
        assert_eq!(bare.waypoints.len(), 2);
        let path = plan(&scene, &state, &to, disc.clone()).unwrap();
        assert!(path.waypoints.len() > 2);
        let crossing = path.waypoints.windows(2).filter(|w| (w[0][0] < 1.6) != (w[1][0] < 1.6));
        for w in crossing {
            let t = (1.6 - w[0][0]) / (w[1][0] - w[0][0]);
            let at = |i: usize| w[0][i] + (w[1][i] - w[0][i]) * t;
            assert!((at(1) - 0.3).hypot(at(2) - 0.4) > disc.disc);
        }
        // Without a rim, no path exists.
        let brief = RrtConnectSettings { max_states: 2_000, ..settings() };
        let wall = Forbidden { disc: 100.0, ..disc };
        let error =
            RrtConnect::new(&scene, RobotId(0)).unwrap().with_constraint(wall).plan(&state, &to, &brief).unwrap_err();
        assert!(matches!(error, RrtConnectError::NotFound { .. }), "{error}");
    }
}

#[test]
fn a_distant_constraint_changes_nothing() {
    let scene = cabinet();
    let mut random = Random(11);
    for _ in 0..3 {
        let (from, to) = (
            free_values(&mut random, &scene, RobotId(0)).unwrap(),
            free_values(&mut random, &scene, RobotId(0)).unwrap(),
        );
        let state = state_at(&scene, RobotId(0), &from);
        let bare = RrtConnect::new(&scene, RobotId(0)).unwrap().plan(&state, &to, &settings());
        let constrained = plan(&scene, &state, &to, Everywhere(f64::INFINITY));
        assert_eq!(bare.map(|r| r.waypoints).ok(), constrained.map(|r| r.waypoints).ok());
    }
}

#[test]
fn a_violating_start_is_left_without_coming_nearer() {
    let scene = example::two_arms();
    let (from, to) = ([0.8, 0.3, 0.4], [2.4, 0.3, 0.4]);
    let state = state_at(&scene, RobotId(0), &from);
    // A violation, a start within the margin, and a goal within the margin.
    let inside = Forbidden::ball(&[0.95, 0.3, 0.4], 0.25);
    let near = Forbidden::ball(&[1.1, 0.3, 0.4], 0.299);
    let arrives = Forbidden::ball(&[2.1, 0.3, 0.4], 0.299);
    for (constraint, from_start) in [(&inside, true), (&near, true), (&arrives, false)] {
        let mut waypoints = plan(&scene, &state, &to, constraint.clone()).unwrap().waypoints;
        assert_eq!((&waypoints[0][..], &waypoints[waypoints.len() - 1][..]), (&from[..], &to[..]));
        if !from_start {
            waypoints.reverse();
        }
        let at_end = constraint.distance(&waypoints[0]);
        assert!(least(constraint, &waypoints[..2], 5_000) >= at_end - 1e-4, "{at_end}");
        assert!(at_end <= 0.0 || least(constraint, &waypoints[..2], 5_000) > 0.0);
        assert!(least(constraint, &waypoints[1..], 5_000) > constraint.margin);
    }
}

#[test]
fn violations_are_reported_by_name() {
    let scene = example::two_arms();
    let (from, to) = ([0.8, 0.3, 0.4], [2.4, 0.3, 0.4]);
    let state = state_at(&scene, RobotId(0), &from);
    let error = plan(&scene, &state, &to, Forbidden::ball(&to, 0.1)).unwrap_err();
    let RrtConnectError::ConstraintViolated { end: PathEnd::Goal, what, metres } = &error else { panic!("{error}") };
    assert!(what == "the ball" && (*metres + 0.1).abs() < 1e-12);
    assert!(error.to_string().contains("goal: it is in the ball"), "{error}");
    // A violation everywhere, or an unknown distance.
    for nowhere in [-1.0, 0.0, f64::NAN] {
        let error = plan(&scene, &state, &to, Everywhere(nowhere)).unwrap_err();
        assert!(matches!(&error, RrtConnectError::ConstraintViolated { what, .. } if what == "everything"), "{error}");
    }
    // Only a ball around the goal is free.
    let shell = Shell { inner: [2.4, 0.3, 0.4], radius: 0.1 };
    let error = plan(&scene, &state, &to, shell).unwrap_err();
    assert!(matches!(error, RrtConnectError::ConstraintViolated { end: PathEnd::Start, .. }), "{error}");
    // An unknown motion bound.
    let error = plan(&scene, &state, &to, Endless).unwrap_err();
    assert!(matches!(error, RrtConnectError::NotFound { .. }), "{error}");
}

/// Forbids everything outside a ball.
#[derive(Debug)]
struct Shell {
    inner: [f64; 3],
    radius: f64,
}

impl PathConstraint for Shell {
    fn distance_m(&mut self, q: &[f64], _limit_m: f64) -> f64 {
        self.radius - self.motion_bound_m(q, &self.inner.clone())
    }

    fn motion_bound_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
        from.iter().zip(to).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    fn describe_nearest(&mut self, _q: &[f64]) -> String {
        "the shell".into()
    }
}

/// A constraint that is satisfied but has no motion bound.
#[derive(Debug)]
struct Endless;

impl PathConstraint for Endless {
    fn distance_m(&mut self, _q: &[f64], _limit_m: f64) -> f64 {
        1.0
    }

    fn motion_bound_m(&mut self, _from: &[f64], _to: &[f64]) -> f64 {
        f64::NAN
    }

    fn describe_nearest(&mut self, _q: &[f64]) -> String {
        "nothing".into()
    }
}
