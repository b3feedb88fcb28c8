//! Routes that stay out of what is fenced off in joint space, beside an oracle that looks at many points of them.

// Others use the rest of it.
#[allow(dead_code)]
#[path = "common/robots.rs"]
mod robots;

use std::time::Duration;

use elbowroom_planner::{Connect, End, Fence, MotionLimits, Route, RouteError, RouteOptions};
use elbowroom_scene::{Scene, SceneState, example};
use robots::{Random, cabinet, crane, standing};

/// What is forbidden to all values together: within `radius` of a point, or of a disc across the first value.
#[derive(Debug, Clone)]
struct Forbidden {
    center: Vec<f64>,
    radius: f64,
    /// Of a disc; 0 for a ball.
    disc: f64,
    /// Kept by ways.
    keep: f64,
}

impl Forbidden {
    fn ball(center: &[f64], radius: f64) -> Self {
        Self { center: center.to_vec(), radius, disc: 0.0, keep: 0.02 }
    }

    fn room(&self, q: &[f64]) -> f64 {
        let off: Vec<f64> = q.iter().zip(&self.center).map(|(q, c)| q - c).collect();
        let along = off[1..].iter().map(|d| d * d).sum::<f64>().sqrt();
        off[0].hypot((along - self.disc).max(0.0)) - self.radius
    }
}

impl Fence for Forbidden {
    fn room_m(&mut self, q: &[f64], _limit_m: f64) -> f64 {
        self.room(q)
    }

    fn spare_m(&mut self, q: &[f64], _limit_m: f64) -> f64 {
        self.room(q) - self.keep
    }

    fn travel_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
        from.iter().zip(to).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    fn nearest(&mut self, _q: &[f64]) -> String {
        "the ball".into()
    }
}

/// A fence that says the same everywhere.
#[derive(Debug)]
struct Everywhere(f64);

impl Fence for Everywhere {
    fn room_m(&mut self, _q: &[f64], _limit_m: f64) -> f64 {
        self.0
    }

    fn travel_m(&mut self, _from: &[f64], _to: &[f64]) -> f64 {
        1.0
    }

    fn nearest(&mut self, _q: &[f64]) -> String {
        "everything".into()
    }
}

fn options() -> RouteOptions {
    RouteOptions { time_limit: Duration::from_secs(2), ..RouteOptions::default() }
}

fn plan(scene: &Scene, state: &SceneState, goal: &[f64], fence: impl Fence) -> Result<Route, RouteError> {
    Connect::new(scene, 0).unwrap().fenced(fence).plan(state, goal, &options())
}

/// The least room at many points of a polyline.
fn least(fence: &Forbidden, path: &[Vec<f64>], points: usize) -> f64 {
    let mut least = f64::INFINITY;
    for w in path.windows(2) {
        for n in 0..=points {
            let t = n as f64 / points as f64;
            let q: Vec<f64> = w[0].iter().zip(&w[1]).map(|(a, b)| a + (b - a) * t).collect();
            least = least.min(fence.room(&q));
        }
    }
    least
}

fn middle(path: &[Vec<f64>]) -> Vec<f64> {
    let long = |w: &&[Vec<f64>]| w[0].iter().zip(&w[1]).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
    let leg = path.windows(2).max_by(|a, b| long(a).total_cmp(&long(b))).unwrap();
    leg[0].iter().zip(&leg[1]).map(|(a, b)| 0.5 * (a + b)).collect()
}

#[test]
fn routes_and_their_motions_stay_out_and_go_through_without_it() {
    let (mut random, mut found, mut asked) = (Random(3), 0, 0);
    for scene in [example::two_arms(), cabinet(), crane()] {
        for _ in 0..8 {
            let (Some(from), Some(to)) = (random.free(&scene, 0), random.free(&scene, 0)) else { continue };
            let state = standing(&scene, 0, &from);
            let Ok(bare) = Connect::new(&scene, 0).unwrap().plan(&state, &to, &options()) else { continue };
            let fence = Forbidden::ball(&middle(&bare.waypoints), 0.4);
            if fence.room(&from).min(fence.room(&to)) < 0.05 {
                continue;
            }
            assert!(least(&fence, &bare.waypoints, 500) < -0.3);
            asked += 1;
            let mut connect = Connect::new(&scene, 0).unwrap().fenced(fence.clone());
            let route = match connect.plan(&state, &to, &options()) {
                Err(RouteError::NotFound { .. }) => continue,
                other => other.unwrap(),
            };
            found += 1;
            assert_eq!((&route.waypoints[0], &route.waypoints[route.waypoints.len() - 1]), (&from, &to));
            assert!(least(&fence, &route.waypoints, 5_000) > fence.keep);
            let dof = to.len();
            let limits = MotionLimits { velocity: vec![2.0; dof], acceleration: vec![8.0; dof], jerk: vec![80.0; dof] };
            let motion = connect.time(&state, &route, &limits, 0.01, &options()).unwrap();
            let rows: Vec<_> = motion.rows(0.01).unwrap().into_iter().map(|r| r.1).collect();
            assert!(least(&fence, &rows, 20) > fence.keep);
        }
    }
    println!("{found} of {asked}");
    assert!(found >= 12 && found * 10 >= asked * 7, "{found} of {asked}");
}

/// Far thinner than any distance between looks; the way is around its rim.
#[test]
fn nothing_is_too_thin_to_be_seen() {
    let scene = example::two_arms();
    for turn in [0.3, 0.5, 0.8] {
        let (from, to) = ([1.6 - turn, 0.3, 0.4], [1.6 + turn, 0.3, 0.4]);
        let disc = Forbidden { center: vec![1.6, 0.3, 0.4], radius: 1e-7, disc: 0.6, keep: 0.0 };
        let state = standing(&scene, 0, &from);
        let bare = Connect::new(&scene, 0).unwrap().plan(&state, &to, &options()).unwrap();
        assert_eq!(bare.waypoints.len(), 2);
        let route = plan(&scene, &state, &to, disc.clone()).unwrap();
        assert!(route.waypoints.len() > 2);
        let crossing = route.waypoints.windows(2).filter(|w| (w[0][0] < 1.6) != (w[1][0] < 1.6));
        for w in crossing {
            let t = (1.6 - w[0][0]) / (w[1][0] - w[0][0]);
            let at = |i: usize| w[0][i] + (w[1][i] - w[0][i]) * t;
            assert!((at(1) - 0.3).hypot(at(2) - 0.4) > disc.disc);
        }
        // One without a rim has no way around.
        let brief = RouteOptions { most_states: 2_000, ..options() };
        let wall = Forbidden { disc: 100.0, ..disc };
        let error = Connect::new(&scene, 0).unwrap().fenced(wall).plan(&state, &to, &brief).unwrap_err();
        assert!(matches!(error, RouteError::NotFound { .. }), "{error}");
    }
}

#[test]
fn a_fence_that_is_far_changes_nothing() {
    let scene = cabinet();
    let mut random = Random(11);
    for _ in 0..3 {
        let (from, to) = (random.free(&scene, 0).unwrap(), random.free(&scene, 0).unwrap());
        let state = standing(&scene, 0, &from);
        let bare = Connect::new(&scene, 0).unwrap().plan(&state, &to, &options());
        let fenced = plan(&scene, &state, &to, Everywhere(f64::INFINITY));
        assert_eq!(bare.map(|r| r.waypoints).ok(), fenced.map(|r| r.waypoints).ok());
    }
}

#[test]
fn a_start_inside_is_left_and_never_gone_deeper() {
    let scene = example::two_arms();
    let (from, to) = ([0.8, 0.3, 0.4], [2.4, 0.3, 0.4]);
    let state = standing(&scene, 0, &from);
    // Inside, within what ways keep, and the other end within it.
    let inside = Forbidden::ball(&[0.95, 0.3, 0.4], 0.25);
    let near = Forbidden::ball(&[1.1, 0.3, 0.4], 0.299);
    let arrives = Forbidden::ball(&[2.1, 0.3, 0.4], 0.299);
    for (fence, from_start) in [(&inside, true), (&near, true), (&arrives, false)] {
        let mut way = plan(&scene, &state, &to, fence.clone()).unwrap().waypoints;
        assert_eq!((&way[0][..], &way[way.len() - 1][..]), (&from[..], &to[..]));
        if !from_start {
            way.reverse();
        }
        let at_end = fence.room(&way[0]);
        assert!(least(fence, &way[..2], 5_000) >= at_end - 1e-4, "{at_end}");
        assert!(at_end <= 0.0 || least(fence, &way[..2], 5_000) > 0.0);
        assert!(least(fence, &way[1..], 5_000) > fence.keep);
    }
}

#[test]
fn what_cannot_be_is_refused_by_name() {
    let scene = example::two_arms();
    let (from, to) = ([0.8, 0.3, 0.4], [2.4, 0.3, 0.4]);
    let state = standing(&scene, 0, &from);
    let error = plan(&scene, &state, &to, Forbidden::ball(&to, 0.1)).unwrap_err();
    let RouteError::Fenced { end: End::Goal, what, metres } = &error else { panic!("{error}") };
    assert!(what == "the ball" && (*metres + 0.1).abs() < 1e-12);
    assert!(error.to_string().contains("goal: it is in the ball"), "{error}");
    // All is inside, or nobody knows.
    for nowhere in [-1.0, 0.0, f64::NAN] {
        let error = plan(&scene, &state, &to, Everywhere(nowhere)).unwrap_err();
        assert!(matches!(&error, RouteError::Fenced { what, .. } if what == "everything"), "{error}");
    }
    // A start in a ball that is everywhere but at the goal.
    let shell = Shell { inner: [2.4, 0.3, 0.4], radius: 0.1 };
    let error = plan(&scene, &state, &to, shell).unwrap_err();
    assert!(matches!(error, RouteError::Fenced { end: End::Start, .. }), "{error}");
    // A bound of motion that is none.
    let error = plan(&scene, &state, &to, Endless).unwrap_err();
    assert!(matches!(error, RouteError::NotFound { .. }), "{error}");
}

/// All but a ball is forbidden.
#[derive(Debug)]
struct Shell {
    inner: [f64; 3],
    radius: f64,
}

impl Fence for Shell {
    fn room_m(&mut self, q: &[f64], _limit_m: f64) -> f64 {
        self.radius - self.travel_m(q, &self.inner.clone())
    }

    fn travel_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
        from.iter().zip(to).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    fn nearest(&mut self, _q: &[f64]) -> String {
        "the shell".into()
    }
}

/// Free, but with no bound of motion.
#[derive(Debug)]
struct Endless;

impl Fence for Endless {
    fn room_m(&mut self, _q: &[f64], _limit_m: f64) -> f64 {
        1.0
    }

    fn travel_m(&mut self, _from: &[f64], _to: &[f64]) -> f64 {
        f64::NAN
    }

    fn nearest(&mut self, _q: &[f64]) -> String {
        "nothing".into()
    }
}
