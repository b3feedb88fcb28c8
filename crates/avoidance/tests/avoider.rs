//! The loop on a small arm: out of the way, back to the path, and calm about it.

mod common;

use common::{Ball, DT, Random, Stage, avoider, scene};
use elbowroom_avoidance::{Around, Doing, PathKind, Reference, Seen};
use elbowroom_spatial::{Motion, Pose, Vec3};

/// Leaning forward, over the table.
const LEAN: [f64; 3] = [0.0, 0.9, 0.6];

fn standing(_: f64) -> (Vec<f64>, Vec<f64>) {
    (LEAN.to_vec(), vec![0.0; 3])
}

/// The waist from -0.8 to 0.8 in two seconds, smoothly.
fn sweeping(tau: f64) -> (Vec<f64>, Vec<f64>) {
    let s = (tau / 2.0).clamp(0.0, 1.0);
    let (f, d) = (s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), 15.0 * s * s * (1.0 - s) * (1.0 - s));
    (vec![-0.8 + 1.6 * f, 0.9, 0.6], vec![1.6 * d, 0.0, 0.0])
}

fn at(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

#[test]
fn with_nothing_near_the_command_is_the_path() {
    let scene = scene();
    let mut stage = Stage::new(&scene, &sweeping(0.0).0);
    while stage.tau < 2.0 {
        let advice = stage.step(&sweeping, PathKind::PointToPoint, &[], 1.0);
        assert_eq!(stage.avoider.q(), sweeping(stage.tau).0);
        assert_eq!((advice.doing, advice.rate, advice.astray_s), (Doing::Following, 1.0, 0.0));
    }
    assert!(stage.hits.is_empty());
}

/// A ball through where the arm stands, from anywhere but across the shoulder, which cannot get out of the way.
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
    let angle = random.range(-2.5, 2.5);
    let speed = random.range(0.1, 0.8);
    let velocity = at(angle.cos(), angle.sin(), random.range(-0.3, 0.3)) * speed;
    let through = at(random.range(0.45, 0.7), random.range(-0.05, 0.05), random.range(0.45, 0.6));
    let from = through - velocity * random.range(1.6, 2.0) * (0.5 / speed).max(1.0);
    Ball { object: 1, from, velocity, stops_s: f64::INFINITY }
}

#[test]
fn what_is_thrown_at_a_standing_arm_misses_it_and_the_arm_comes_back() {
    let scene = scene();
    let mut random = Random(11);
    let (mut would_hit, mut hit) = (0, 0);
    for _ in 0..60 {
        let ball = thrown(&mut random);
        let mut stage = Stage::new(&scene, &LEAN);
        let mut touched = false;
        let mut still = elbowroom_scene::SceneState::new(&scene);
        still.set_q(&scene, 0, &LEAN).unwrap();
        let mut checker = elbowroom_scene::Checker::new(&scene, elbowroom_scene::Options::default());
        while stage.t < 3.0 || (stage.avoider.q() != LEAN && stage.t < 40.0) {
            still.place(&scene, 1, ball.seen(stage.t).in_world).unwrap();
            touched |= checker.collides(&still).is_some();
            stage.step(&standing, PathKind::PointToPoint, &[ball], 1.0);
            stage.plan(&LEAN);
        }
        assert!(stage.fastest <= 1.0 + 1e-9 && stage.quietest() >= 0.25 - DT, "{}", stage.quietest());
        if touched {
            would_hit += 1;
            hit += usize::from(!stage.hits.is_empty());
            assert_eq!(stage.avoider.q(), LEAN, "it is back exactly");
        }
    }
    assert!(would_hit >= 25, "only {would_hit} of 60 balls would hit a standing arm");
    // Three joints cannot get out of every way.
    assert!(hit <= would_hit / 20, "{hit} of {would_hit} hit");
}

#[test]
fn head_on_is_no_tie() {
    let scene = scene();
    let tip = at(0.75, 0.0, 0.53);
    for height in [0.0, 0.05] {
        let velocity = at(-0.4, 0.0, 0.0);
        let ball = Ball { object: 1, from: tip + at(1.0, 0.0, height), velocity, stops_s: f64::INFINITY };
        let mut stage = Stage::new(&scene, &LEAN);
        let mut farthest: f64 = 0.0;
        while stage.t < 12.0 {
            stage.step(&standing, PathKind::PointToPoint, &[ball], 1.0);
            stage.plan(&LEAN);
            farthest = farthest.max(stage.avoider.q()[0].abs());
        }
        assert!(stage.hits.is_empty(), "hit at {:?}", stage.hits.first());
        assert!(farthest > 0.1, "it went aside");
        assert_eq!(stage.avoider.q(), LEAN);
    }
}

#[test]
fn a_trapped_arm_stands_still() {
    let scene = scene();
    // Two balls close in from both sides and stay.
    let side = |object, y: f64| {
        let from = at(0.6, y, 0.55);
        Ball { object, from, velocity: at(0.0, -y.signum() * 0.3, 0.0), stops_s: (y.abs() - 0.26) / 0.3 }
    };
    let balls = [side(1, 0.9), side(2, -0.9)];
    let mut stage = Stage::new(&scene, &LEAN);
    let mut late: f64 = 0.0;
    while stage.t < 10.0 {
        stage.step(&standing, PathKind::PointToPoint, &balls, 1.0);
        if stage.t > 6.0 {
            late = late.max(stage.avoider.qd().iter().fold(0.0, |m, v| m.max(v.abs())));
        }
    }
    assert!(stage.hits.is_empty());
    assert!(late < 1e-3, "it still moves at {late} rad/s");
    assert!(stage.quietest() >= 0.25 - DT);
}

#[test]
fn a_seam_is_slowed_down_on_and_resumed_not_left() {
    let scene = scene();
    // A ball that stands on the path, and goes away after a while.
    let mut stage = Stage::new(&scene, &sweeping(0.0).0);
    let stands = Ball { object: 1, from: at(0.74, 0.2, 0.53), velocity: Vec3::ZERO, stops_s: 0.0 };
    let mut farthest: f64 = 0.0;
    while stage.t < 4.0 {
        let advice = stage.step(&sweeping, PathKind::Continuous, &[stands], 1.0);
        farthest = farthest.max(advice.astray_s);
    }
    assert!(stage.tau > 0.3 && stage.tau < 1.5, "it waits before the ball: {}", stage.tau);
    assert!(farthest < 0.02, "and does not leave the seam: {farthest}");
    assert_eq!(stage.advice.doing, Doing::Waiting);
    let waited = stage.tau;
    // Not to be seen is not to be gone.
    for _ in 0..100 {
        stage.step(&sweeping, PathKind::Continuous, &[], 1.0);
    }
    assert!((stage.tau - waited).abs() < 1e-3, "{} {waited}", stage.tau);
    let gone = Ball { from: at(9.0, 9.0, 9.0), ..stands };
    while stage.tau < 2.0 {
        stage.step(&sweeping, PathKind::Continuous, &[gone], 1.0);
        assert!(stage.tau >= waited && stage.t < 9.0);
    }
    assert!(stage.hits.is_empty());
    assert_eq!(stage.avoider.q(), sweeping(stage.tau).0);
}

#[test]
fn around_what_stands_there_is_a_way() {
    let scene = scene();
    let ball = Ball { object: 1, from: at(0.74, 0.0, 0.53), velocity: Vec3::ZERO, stops_s: 0.0 };
    let mut stage = Stage::new(&scene, &sweeping(0.0).0);
    while stage.t < 20.0 && stage.avoider.q() != sweeping(2.0).0 {
        stage.step(&sweeping, PathKind::PointToPoint, &[ball], 1.0);
        if stage.plan(&sweeping(2.0).0) {
            stage.tau = 2.0;
        }
    }
    assert!(stage.hits.is_empty());
    assert_eq!(stage.avoider.q(), sweeping(2.0).0);
    assert!(stage.planned <= 2, "{} ways", stage.planned);
}

#[test]
fn the_override_scales_everything_and_zero_stops_it() {
    let scene = scene();
    let ball = Ball { object: 1, from: at(0.7, -1.2, 0.5), velocity: at(0.0, 0.5, 0.0), stops_s: f64::INFINITY };
    let fastest = |speed_override: f64| {
        let mut stage = Stage::new(&scene, &LEAN);
        while stage.t < 3.0 {
            stage.step(&standing, PathKind::PointToPoint, &[ball], speed_override);
        }
        stage.fastest
    };
    let full = fastest(1.0);
    assert!(full > 0.1, "the ball makes it move: {full}");
    assert!(fastest(0.3) <= 0.3 + 1e-9);
    assert_eq!(fastest(0.0), 0.0);
    assert_eq!(fastest(f64::NAN), 0.0);
}

#[test]
fn nonsense_is_refused_and_moves_nothing() {
    let scene = scene();
    let mut avoider = avoider(&scene, &LEAN);
    let reference = Reference { q: &LEAN, qd: &[0.0; 3], path: PathKind::PointToPoint };
    let nan = Pose::from_translation(at(f64::NAN, 0.0, 0.0));
    let bad = [
        Seen { object: 1, in_world: nan, motion: Motion::REST, known: false },
        Seen { object: 9, in_world: Pose::IDENTITY, motion: Motion::REST, known: false },
        Seen {
            object: 1,
            in_world: Pose::from_translation(at(3.0, 0.0, 0.0)),
            motion: Motion { velocity: at(f64::NAN, 0.0, 0.0), ..Motion::REST },
            known: false,
        },
    ];
    for seen in bad {
        assert!(avoider.tick(DT, &reference, &Around { objects: &[seen], robots: &[] }, 1.0).is_err());
        assert_eq!(avoider.q(), LEAN);
    }
    let nowhere = Reference { q: &[f64::NAN; 3], qd: &[0.0; 3], path: PathKind::PointToPoint };
    assert!(avoider.tick(DT, &nowhere, &Around::default(), 1.0).is_err());
    for dt in [0.0, -1.0, f64::NAN] {
        assert!(avoider.tick(dt, &reference, &Around::default(), 1.0).is_err());
    }
    assert_eq!(avoider.q(), LEAN);
    // An arm within the ball does not know a way out, and does not jump.
    let inside =
        Seen { object: 1, in_world: Pose::from_translation(at(0.6, 0.0, 0.6)), motion: Motion::REST, known: false };
    for _ in 0..100 {
        avoider.tick(DT, &reference, &Around { objects: &[inside], robots: &[] }, 1.0).unwrap();
        assert!(avoider.q().iter().all(|v| v.is_finite()));
    }
}

#[test]
fn whatever_comes_limits_are_kept_and_the_arm_is_calm() {
    let scene = scene();
    let mut random = Random(5);
    for _ in 0..30 {
        let mut thrown_at = |object| Ball { object, ..thrown(&mut random) };
        let balls = [thrown_at(1), thrown_at(2)];
        let mut stage = Stage::new(&scene, &sweeping(0.0).0);
        while stage.t < 5.0 {
            stage.step(&sweeping, PathKind::PointToPoint, &balls, 1.0);
        }
        assert!(stage.fastest <= 1.0 + 1e-9);
        assert!(stage.quietest() >= 0.25 - DT, "{}", stage.quietest());
    }
}
