//! The control loop on a small arm: the arm evades, returns to its path, and does not oscillate.

use crate::common;
use crate::common::{Ball, DT, Simulation, avoider, limits, scene};
use elbowroom_avoidance::{
    Avoider, AvoiderSettings, AvoiderState, DynamicObstacles, ObservedObject, PathKind, Reference, Rules,
};
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_spatial::{FrameMotion, Pose, Vec3};
use elbowroom_testkit::random::Random;

/// A configuration above the table.
const LEAN: [f64; 3] = [0.0, 0.9, 0.6];

fn at_rest(_: f64) -> (Vec<f64>, Vec<f64>) {
    (LEAN.to_vec(), vec![0.0; 3])
}

/// A smooth motion of the first joint from -0.8 to 0.8 in two seconds.
fn sweeping(tau: f64) -> (Vec<f64>, Vec<f64>) {
    let s = (tau / 2.0).clamp(0.0, 1.0);
    let (f, d) = (s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), 15.0 * s * s * (1.0 - s) * (1.0 - s));
    (vec![-0.8 + 1.6 * f, 0.9, 0.6], vec![1.6 * d, 0.0, 0.0])
}

fn at(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

#[test]
fn without_obstacles_the_command_equals_the_reference() {
    let scene = scene();
    let mut simulation = Simulation::new(&scene, &sweeping(0.0).0);
    while simulation.tau < 2.0 {
        let output = simulation.step(&sweeping, PathKind::PointToPoint, &[], 1.0);
        assert_eq!(simulation.avoider.q(), sweeping(simulation.tau).0);
        assert_eq!((output.state, output.rate, output.path_deviation_s), (AvoiderState::Following, 1.0, 0.0));
    }
    assert!(simulation.hits.is_empty());
}

/// A ball that hits the arm at rest, from any direction except across the shoulder, which cannot evade.
fn thrown(random: &mut Random) -> Ball {
    loop {
        let ball = any_ball(random);
        let flat = at(ball.velocity.x, ball.velocity.y, 0.0).try_normalize().unwrap();
        if ball.from.cross(flat).z.abs() > 0.25 {
            return ball;
        }
    }
}

fn any_ball(random: &mut Random) -> Ball {
    let angle = random.between(-2.5, 2.5);
    let speed = random.between(0.1, 0.8);
    let velocity = at(angle.cos(), angle.sin(), random.between(-0.3, 0.3)) * speed;
    let through = at(random.between(0.45, 0.7), random.between(-0.05, 0.05), random.between(0.45, 0.6));
    let from = through - velocity * random.between(1.6, 2.0) * (0.5 / speed).max(1.0);
    Ball { object: ObjectId(1), from, velocity, stops_s: f64::INFINITY }
}

#[test]
fn a_ball_thrown_at_an_arm_at_rest_misses_and_the_arm_returns() {
    let scene = scene();
    let mut random = Random(11);
    let (mut would_hit, mut hit) = (0, 0);
    for _ in 0..60 {
        let ball = thrown(&mut random);
        let mut simulation = Simulation::new(&scene, &LEAN);
        let mut touched = false;
        let mut at_rest_state = elbowroom_scene::SceneState::new(&scene);
        at_rest_state.set_q(&scene, RobotId(0), &LEAN).unwrap();
        let mut checker = elbowroom_scene::Checker::new(&scene, elbowroom_scene::CheckerOptions::default());
        while simulation.t < 3.0 || (simulation.avoider.q() != LEAN && simulation.t < 40.0) {
            at_rest_state.place(&scene, ObjectId(1), ball.observed(simulation.t).in_world).unwrap();
            touched |= checker.collides(&at_rest_state).is_some();
            simulation.step(&at_rest, PathKind::PointToPoint, &[ball], 1.0);
            simulation.plan(&LEAN);
        }
        assert!(
            simulation.max_speed <= 1.0 + 1e-9 && simulation.min_reversal_interval() >= 0.25 - DT,
            "{}",
            simulation.min_reversal_interval()
        );
        if touched {
            would_hit += 1;
            hit += usize::from(!simulation.hits.is_empty());
            assert_eq!(simulation.avoider.q(), LEAN, "it returns exactly");
        }
    }
    assert!(would_hit >= 25, "only {would_hit} of 60 balls would hit an arm at rest");
    // Three joints cannot evade every ball.
    assert!(hit <= would_hit / 20, "{hit} of {would_hit} hit");
}

#[test]
fn a_head_on_approach_is_evaded_sideways() {
    let scene = scene();
    let tip = at(0.75, 0.0, 0.53);
    for height in [0.0, 0.05] {
        let velocity = at(-0.4, 0.0, 0.0);
        let ball = Ball { object: ObjectId(1), from: tip + at(1.0, 0.0, height), velocity, stops_s: f64::INFINITY };
        let mut simulation = Simulation::new(&scene, &LEAN);
        let mut farthest: f64 = 0.0;
        while simulation.t < 12.0 {
            simulation.step(&at_rest, PathKind::PointToPoint, &[ball], 1.0);
            simulation.plan(&LEAN);
            farthest = farthest.max(simulation.avoider.q()[0].abs());
        }
        assert!(simulation.hits.is_empty(), "hit at {:?}", simulation.hits.first());
        assert!(farthest > 0.1, "it evades sideways");
        assert_eq!(simulation.avoider.q(), LEAN);
    }
}

#[test]
fn what_is_predicted_to_pass_is_not_evaded() {
    let scene = scene();
    // The ball passes the tip at 0.25 to 0.3 m, across and towards the base.
    let passing = [(at(1.15, -1.0, 0.53), at(0.0, 0.5, 0.0)), (at(1.5, 0.42, 0.5), at(-0.5, 0.0, 0.0))];
    for (from, velocity) in passing {
        let ball = Ball { object: ObjectId(1), from, velocity, stops_s: f64::INFINITY };
        let run = |horizon_s: f64| {
            let mut settings = AvoiderSettings::default();
            settings.escape.horizon_s = horizon_s;
            let limits = common::limits(&scene);
            let avoider = Avoider::new(&scene, RobotId(0), &LEAN, &limits, Rules::default(), settings).unwrap();
            let mut simulation = Simulation::with(&scene, &LEAN, avoider);
            let (mut nearest_m, mut deviation_s): (f64, f64) = (f64::INFINITY, 0.0);
            while simulation.t < 6.0 {
                let output = simulation.step(&at_rest, PathKind::PointToPoint, &[ball], 1.0);
                nearest_m = nearest_m.min(output.nearest_m);
                deviation_s = deviation_s.max(output.path_deviation_s);
            }
            assert!(simulation.hits.is_empty());
            (nearest_m, deviation_s)
        };
        let (nearest_m, deviation_s) = run(3.0);
        assert!((0.15..0.4).contains(&nearest_m), "{nearest_m}");
        assert_eq!(deviation_s, 0.0, "it stays");
        assert!(run(0.0).1 > 0.01, "without a prediction the rules make it leave");
    }
}

#[test]
fn a_trapped_arm_stays_at_rest() {
    let scene = scene();
    // Two balls close in from both sides and stay.
    let side = |object, y: f64| {
        let from = at(0.6, y, 0.55);
        Ball { object, from, velocity: at(0.0, -y.signum() * 0.3, 0.0), stops_s: (y.abs() - 0.26) / 0.3 }
    };
    let balls = [side(ObjectId(1), 0.9), side(ObjectId(2), -0.9)];
    let mut simulation = Simulation::new(&scene, &LEAN);
    let mut late: f64 = 0.0;
    while simulation.t < 10.0 {
        simulation.step(&at_rest, PathKind::PointToPoint, &balls, 1.0);
        if simulation.t > 6.0 {
            late = late.max(simulation.avoider.qd().iter().fold(0.0, |m, v| m.max(v.abs())));
        }
    }
    assert!(simulation.hits.is_empty());
    assert!(late < 1e-3, "it moves at {late} rad/s");
    assert!(simulation.min_reversal_interval() >= 0.25 - DT);
}

#[test]
fn a_continuous_path_is_slowed_down_and_resumed_not_left() {
    let scene = scene();
    // A ball at rest on the path, which is removed later.
    let mut simulation = Simulation::new(&scene, &sweeping(0.0).0);
    let resting = Ball { object: ObjectId(1), from: at(0.74, 0.2, 0.53), velocity: Vec3::ZERO, stops_s: 0.0 };
    let mut farthest: f64 = 0.0;
    while simulation.t < 4.0 {
        let output = simulation.step(&sweeping, PathKind::Continuous, &[resting], 1.0);
        farthest = farthest.max(output.path_deviation_s);
    }
    assert!(simulation.tau > 0.3 && simulation.tau < 1.5, "it waits before the ball: {}", simulation.tau);
    assert!(farthest < 0.02, "it does not leave the path: {farthest}");
    assert_eq!(simulation.output.state, AvoiderState::Waiting);
    let waited = simulation.tau;
    // An object that is no longer observed is still there.
    for _ in 0..100 {
        simulation.step(&sweeping, PathKind::Continuous, &[], 1.0);
    }
    assert!((simulation.tau - waited).abs() < 1e-3, "{} {waited}", simulation.tau);
    let removed = Ball { from: at(9.0, 9.0, 9.0), ..resting };
    while simulation.tau < 2.0 {
        simulation.step(&sweeping, PathKind::Continuous, &[removed], 1.0);
        assert!(simulation.tau >= waited && simulation.t < 9.0);
    }
    assert!(simulation.hits.is_empty());
    assert_eq!(simulation.avoider.q(), sweeping(simulation.tau).0);
}

#[test]
fn a_detour_leads_around_a_stationary_obstacle() {
    let scene = scene();
    let ball = Ball { object: ObjectId(1), from: at(0.74, 0.0, 0.53), velocity: Vec3::ZERO, stops_s: 0.0 };
    let mut simulation = Simulation::new(&scene, &sweeping(0.0).0);
    while simulation.t < 20.0 && simulation.avoider.q() != sweeping(2.0).0 {
        simulation.step(&sweeping, PathKind::PointToPoint, &[ball], 1.0);
        if simulation.plan(&sweeping(2.0).0) {
            simulation.tau = 2.0;
        }
    }
    assert!(simulation.hits.is_empty());
    assert_eq!(simulation.avoider.q(), sweeping(2.0).0);
    assert!(simulation.planned <= 2, "{} detours", simulation.planned);
}

#[test]
fn a_detour_is_not_faster_than_the_path_unless_that_is_asked_for() {
    let scene = scene();
    let ball = Ball { object: ObjectId(1), from: at(0.74, 0.0, 0.53), velocity: Vec3::ZERO, stops_s: 0.0 };
    for (speed_share, asked, most) in [(1.0, None, 0.5), (0.2, None, 0.2), (0.2, Some(0.4), 0.4), (0.0, None, 0.01)] {
        let settings = AvoiderSettings { return_speed_fraction: asked, ..AvoiderSettings::default() };
        let (q, limits) = (sweeping(0.0).0, limits(&scene));
        let avoider = Avoider::new(&scene, RobotId(0), &q, &limits, Rules::default(), settings).unwrap();
        let mut simulation = Simulation::with(&scene, &q, avoider);
        simulation.speed_share = speed_share;
        let mut fastest = 0.0;
        while simulation.t < 20.0 && simulation.avoider.q() != sweeping(2.0).0 {
            let on_detour = simulation.avoider.has_detour();
            simulation.step(&sweeping, PathKind::PointToPoint, &[ball], 1.0);
            let speeds = simulation.avoider.qd().iter().zip(&limits);
            let speed = speeds.fold(0.0_f64, |most, (v, limit)| most.max(v.abs() / limit.velocity));
            fastest = if on_detour { f64::max(fastest, speed) } else { fastest };
            if simulation.plan(&sweeping(2.0).0) {
                simulation.tau = 2.0;
            }
        }
        assert!(fastest > 0.9 * most && fastest <= most * (1.0 + 1e-9), "{speed_share}, {asked:?}: {fastest}");
        assert!(simulation.hits.is_empty() && simulation.planned > 0);
    }
}

#[test]
fn the_override_scales_everything_and_zero_stops_it() {
    let scene = scene();
    let ball =
        Ball { object: ObjectId(1), from: at(0.7, -1.2, 0.5), velocity: at(0.0, 0.5, 0.0), stops_s: f64::INFINITY };
    let max_speed = |speed_override: f64| {
        let mut simulation = Simulation::new(&scene, &LEAN);
        while simulation.t < 3.0 {
            simulation.step(&at_rest, PathKind::PointToPoint, &[ball], speed_override);
        }
        simulation.max_speed
    };
    let full = max_speed(1.0);
    assert!(full > 0.1, "the ball makes it move: {full}");
    assert!(max_speed(0.3) <= 0.3 + 1e-9);
    assert_eq!(max_speed(0.0), 0.0);
    assert_eq!(max_speed(f64::NAN), 0.0);
}

#[test]
fn invalid_input_is_refused_and_commands_nothing() {
    let scene = scene();
    let mut avoider = avoider(&scene, &LEAN);
    let reference = Reference { q: &LEAN, qd: &[0.0; 3], speed_share: 1.0, path: PathKind::PointToPoint };
    let nan = Pose::from_translation(at(f64::NAN, 0.0, 0.0));
    let invalid = [
        ObservedObject { object: ObjectId(1), in_world: nan, motion: FrameMotion::REST, known: false },
        ObservedObject { object: ObjectId(9), in_world: Pose::IDENTITY, motion: FrameMotion::REST, known: false },
        ObservedObject {
            object: ObjectId(1),
            in_world: Pose::from_translation(at(3.0, 0.0, 0.0)),
            motion: FrameMotion { velocity: at(f64::NAN, 0.0, 0.0), ..FrameMotion::REST },
            known: false,
        },
    ];
    for observed in invalid {
        assert!(avoider.tick(DT, &reference, &DynamicObstacles { objects: &[observed], robots: &[] }, 1.0).is_err());
        assert_eq!(avoider.q(), LEAN);
    }
    let not_finite = Reference { q: &[f64::NAN; 3], qd: &[0.0; 3], speed_share: 1.0, path: PathKind::PointToPoint };
    assert!(avoider.tick(DT, &not_finite, &DynamicObstacles::default(), 1.0).is_err());
    for dt in [0.0, -1.0, f64::NAN] {
        assert!(avoider.tick(dt, &reference, &DynamicObstacles::default(), 1.0).is_err());
    }
    assert_eq!(avoider.q(), LEAN);
    // An arm inside the ball has no escape direction and does not jump.
    let inside = ObservedObject {
        object: ObjectId(1),
        in_world: Pose::from_translation(at(0.6, 0.0, 0.6)),
        motion: FrameMotion::REST,
        known: false,
    };
    for _ in 0..100 {
        avoider.tick(DT, &reference, &DynamicObstacles { objects: &[inside], robots: &[] }, 1.0).unwrap();
        assert!(avoider.q().iter().all(|v| v.is_finite()));
    }
}

#[test]
fn limits_are_kept_and_the_arm_does_not_oscillate() {
    let scene = scene();
    let mut random = Random(5);
    for _ in 0..30 {
        let mut thrown_at = |object| Ball { object, ..thrown(&mut random) };
        let balls = [thrown_at(ObjectId(1)), thrown_at(ObjectId(2))];
        let mut simulation = Simulation::new(&scene, &sweeping(0.0).0);
        while simulation.t < 5.0 {
            simulation.step(&sweeping, PathKind::PointToPoint, &balls, 1.0);
        }
        assert!(simulation.max_speed <= 1.0 + 1e-9);
        assert!(simulation.min_reversal_interval() >= 0.25 - DT, "{}", simulation.min_reversal_interval());
    }
}
