//! Invalid input and incomplete observations: no collision, no panic.

use crate::common;
use crate::common::{DT, Simulation, avoider, limits, scene};
use elbowroom_avoidance::{
    AvoidanceError, Avoider, AvoiderOutput, AvoiderSettings, DynamicObstacles, Neighbour, ObservedObject, PathKind,
    Reference, Rules,
};
use elbowroom_kinematics::JointLimits;
use elbowroom_planner::RrtConnectSettings;
use elbowroom_proximity::{Cuboid, Shape, Sphere};
use elbowroom_robot::{ObjectId, RobotId, example::arm};
use elbowroom_scene::{Checker, CheckerOptions, Object, Scene, SceneState, Selection, example};
use elbowroom_spatial::{FrameMotion, Pose, Vec3};
use elbowroom_testkit::random::Random;

const HERE: [f64; 3] = [-0.8, 0.9, 0.6];
const THERE: [f64; 3] = [0.8, 0.9, 0.6];

fn at(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

fn ball(place: Vec3, known: bool) -> ObservedObject {
    ObservedObject { object: ObjectId(1), in_world: Pose::from_translation(place), motion: FrameMotion::REST, known }
}

fn resting_at(q: &[f64]) -> Reference<'_> {
    Reference { q, qd: &[0.0; 3], speed_share: 1.0, path: PathKind::PointToPoint }
}

fn clearance(clearance_m: f64) -> RrtConnectSettings {
    RrtConnectSettings { clearance_m, ..RrtConnectSettings::default() }
}

/// Distance of the robot from all obstacles, with the ball at `place`.
fn distance(scene: &Scene, q: &[f64], place: Option<Vec3>) -> f64 {
    let mut state = SceneState::new(scene);
    state.set_q(scene, RobotId(0), q).unwrap();
    if let Some(place) = place {
        state.place(scene, ObjectId(1), Pose::from_translation(place)).unwrap();
    }
    let mut checker = Checker::new(scene, CheckerOptions::default());
    let mut all = checker.between(Selection::Robot(RobotId(0)), Selection::All);
    all.distance(&state).map_or(f64::INFINITY, |d| d.metres)
}

/// Smallest distance on a planned detour when the ball appears on it, observed in the ticks given by `observed`.
fn min_distance(
    scene: &Scene,
    limits: &[JointLimits],
    rules: Rules,
    known: bool,
    observed: impl Fn(usize) -> bool,
) -> f64 {
    let settings = AvoiderSettings { return_speed_fraction: Some(1.0), ..AvoiderSettings::default() };
    let mut avoider = Avoider::new(scene, RobotId(0), &HERE, limits, rules, settings).unwrap();
    let far = ball(at(3.0, 3.0, 3.0), known);
    avoider.tick(DT, &resting_at(&HERE), &DynamicObstacles { objects: &[far], robots: &[] }, 1.0).unwrap();
    avoider.plan_to(&THERE, &clearance(0.02)).unwrap();
    let place = at(0.70, 0.0, 0.63);
    let mut smallest = f64::INFINITY;
    for n in 0..1_000 {
        let observed_ball = [ball(place, known)];
        let objects = if observed(n) { &observed_ball[..] } else { &[] };
        avoider.tick(DT, &resting_at(&THERE), &DynamicObstacles { objects, robots: &[] }, 1.0).unwrap();
        smallest = smallest.min(distance(scene, avoider.q(), Some(place)));
    }
    smallest
}

#[test]
fn an_object_that_is_no_longer_observed_is_assumed_stationary() {
    let scene = scene();
    for known in [false, true] {
        assert!(min_distance(&scene, &limits(&scene), Rules::default(), known, |_| true) > 1e-3);
        assert!(min_distance(&scene, &limits(&scene), Rules::default(), known, |n| n < 3) > 1e-3);
    }
}

#[test]
fn rules_with_less_reach_than_a_stop_cause_no_hit() {
    let scene = scene();
    // All distances are a tenth of the default ones.
    let text: String = elbowroom_avoidance::DEFAULT_RULES
        .lines()
        .scan(false, |near, line| {
            if line.starts_with('[') {
                *near = line.contains("proximity");
            }
            let scaled = line.split_once('=').filter(|_| *near && line.contains('[') && !line.starts_with('['));
            Some(scaled.map_or_else(|| line.to_owned(), |(key, list)| format!("{key}= {}", tenth(list))) + "\n")
        })
        .collect();
    let rules = || Rules::from_toml(&text).unwrap();
    assert!((rules().reach_m() - 0.1 * Rules::default().reach_m()).abs() < 1e-9);
    let limits = JointLimits::of_chain(&scene.robots()[0].robot.chain, 0.5, 0.5, 2.0);
    for known in [false, true] {
        assert!(min_distance(&scene, &limits, rules(), known, |_| true) > 1e-3, "known {known}");
    }
}

/// The numbers of a list divided by ten.
fn tenth(list: &str) -> String {
    let inner = list.trim().trim_start_matches('[');
    let numbers = inner.split(']').next().unwrap().split(',').map(|n| 0.1 * n.trim().parse::<f64>().unwrap());
    format!("{:?}", numbers.collect::<Vec<_>>())
}

#[test]
fn a_robot_without_updates_is_assumed_stationary() {
    let scene = example::two_arms();
    let limits = JointLimits::of_chain(&scene.robots()[0].robot.chain, 0.25, 0.1, 2.0);
    let (from, goal, other) = ([1.2, 1.2, 0.3], [-1.2, 1.2, 0.3], [0.0, -1.2, -0.3]);
    let reported = [Neighbour { robot: RobotId(1), q: &other, qd: &[0.0; 3], known: false }];
    let mut avoider =
        Avoider::new(&scene, RobotId(0), &from, &limits, Rules::default(), AvoiderSettings::default()).unwrap();
    avoider.tick(DT, &resting_at(&from), &DynamicObstacles { objects: &[], robots: &reported }, 1.0).unwrap();
    avoider.plan_to(&[1.4, 1.2, 0.3], &RrtConnectSettings::default()).unwrap();
    let (mut state, mut checker) = (SceneState::new(&scene), Checker::new(&scene, CheckerOptions::default()));
    state.set_q(&scene, RobotId(1), &other).unwrap();
    for _ in 0..2_000 {
        avoider.tick(DT, &resting_at(&goal), &DynamicObstacles::default(), 1.0).unwrap();
        state.set_q(&scene, RobotId(0), avoider.q()).unwrap();
        let near = checker.between(Selection::Robot(RobotId(0)), Selection::Robot(RobotId(1))).within(&state, 1e-3);
        assert!(near.is_none(), "{:?}", avoider.q());
    }
}

#[test]
fn detours_keep_to_limits_narrower_than_those_of_the_robot() {
    let mut builder = Scene::builder();
    builder.robot("arm", arm().unwrap(), Pose::IDENTITY);
    let pillar = Shape::Cuboid(Cuboid { half_extents: at(0.05, 0.05, 0.45) });
    let in_world = Pose::from_translation(at(0.6, 0.0, 0.45));
    builder.object(Object { name: "pillar".into(), shape: pillar, in_world });
    let scene = builder.build().unwrap();
    let mut narrow = limits(&scene);
    let tick = |avoider: &mut Avoider<'_>, to: &[f64]| {
        avoider.tick(DT, &resting_at(to), &DynamicObstacles::default(), 1.0).unwrap()
    };
    let few = RrtConnectSettings { max_states: 2_000, ..clearance(0.02) };

    let mut free =
        Avoider::new(&scene, RobotId(0), &HERE, &narrow, Rules::default(), AvoiderSettings::default()).unwrap();
    tick(&mut free, &HERE);
    free.plan_to(&THERE, &few).unwrap();
    // The narrow limits do not allow a detour over the pillar.
    (narrow[1].lower, narrow[2].lower, narrow[2].upper) = (0.7, 0.4, 0.8);
    let mut held =
        Avoider::new(&scene, RobotId(0), &HERE, &narrow, Rules::default(), AvoiderSettings::default()).unwrap();
    tick(&mut held, &HERE);
    let planned = held.plan_to(&THERE, &few);
    for _ in 0..1_500 {
        tick(&mut held, &THERE);
        assert!(distance(&scene, held.q(), None) > 1e-4 && held.q()[1] >= 0.7, "{planned:?}: {:?}", held.q());
    }
}

#[test]
fn many_fixed_obstacles_do_not_stop_a_detour() {
    let mut builder = Scene::builder();
    builder.robot("arm", arm().unwrap(), Pose::IDENTITY);
    for i in 0..400 {
        let (angle, row) = (f64::from(i / 5) / 80.0 * 3.0 - 1.5, f64::from(i % 5));
        let in_world = Pose::from_translation(at(0.81 * angle.cos(), 0.81 * angle.sin(), 0.48 + 0.03 * row));
        builder.object(Object { name: format!("s{i}"), shape: Shape::Sphere(Sphere { radius: 0.01 }), in_world });
    }
    let scene = builder.build().unwrap();
    let limits = JointLimits::of_chain(&scene.robots()[0].robot.chain, 0.5, 0.5, 2.0);
    let (from, to) = ([-0.8, 0.9, 0.9], [0.8, 0.9, 0.9]);
    let mut avoider =
        Avoider::new(&scene, RobotId(0), &from, &limits, Rules::default(), AvoiderSettings::default()).unwrap();
    avoider.tick(DT, &resting_at(&from), &DynamicObstacles::default(), 1.0).unwrap();
    avoider.plan_to(&to, &clearance(0.02)).unwrap();
    let mut ticks = 0;
    while avoider.q() != to {
        let output: AvoiderOutput = avoider.tick(DT, &resting_at(&to), &DynamicObstacles::default(), 1.0).unwrap();
        assert!(
            !output.braked && (avoider.has_detour() || output.path_deviation_s < 1e-6) && ticks < 2_000,
            "tick {ticks}"
        );
        ticks += 1;
    }
}

#[test]
fn invalid_limits_are_refused() {
    let scene = scene();
    let make = |limits: &[JointLimits]| {
        Avoider::new(&scene, RobotId(0), &HERE, limits, Rules::default(), AvoiderSettings::default())
    };
    let good = limits(&scene);
    assert!(make(&good).is_ok());
    for count in [0, 1, 4] {
        let some: Vec<_> = good.iter().cycle().take(count).copied().collect();
        assert!(matches!(make(&some).unwrap_err(), AvoidanceError::Limits { joints: 3, .. }));
    }
    let spoil: [fn(&mut JointLimits, f64); 5] = [
        |l, v| l.velocity = v,
        |l, v| l.acceleration = v,
        |l, v| l.stop = v,
        |l, v| (l.lower, l.upper) = (v, -v),
        |l, v| (l.lower, l.upper) = (3.0, v),
    ];
    for spoil in spoil {
        for value in [f64::NAN, -1.0, f64::NEG_INFINITY] {
            let mut bad = good.clone();
            spoil(&mut bad[1], value);
            // The range from −1 to 1 is valid.
            let is_range = bad[1].lower <= bad[1].upper && bad[1].velocity > 0.0 && bad[1].acceleration > 0.0;
            if is_range && bad[1].stop == good[1].stop {
                continue;
            }
            assert!(matches!(make(&bad).unwrap_err(), AvoidanceError::Limit { joint: 1, .. }), "{:?}", bad[1]);
        }
    }
}

#[test]
fn a_detour_does_not_start_in_motion() {
    let scene = scene();
    let mut simulation = Simulation::new(&scene, &HERE);
    let sweeping = |tau: f64| {
        let s = (tau / 2.0).clamp(0.0, 1.0);
        let (f, d) = (s * s * s * (10.0 - 15.0 * s + 6.0 * s * s), 15.0 * s * s * (1.0 - s) * (1.0 - s));
        (vec![-0.8 + 1.6 * f, 0.9, 0.6], vec![1.6 * d, 0.0, 0.0])
    };
    while simulation.tau < 1.0 {
        simulation.step(&sweeping, PathKind::PointToPoint, &[], 1.0);
    }
    let error = simulation.avoider.plan_to(&HERE, &RrtConnectSettings::default()).unwrap_err();
    assert_eq!(error, AvoidanceError::NotStationary);
}

#[test]
fn a_robot_pushed_off_its_goal_by_an_obstacle_at_rest_rests_until_its_detour_is_known() {
    let scene = scene();
    let (mut random, mut followed) = (Random(7), 0);
    while followed < 10 {
        let place = at(random.between(0.2, 0.9), random.between(-0.9, -0.2), random.between(0.1, 0.9));
        if !(0.01..0.2).contains(&distance(&scene, &HERE, Some(place))) {
            continue;
        }
        let mut avoider = avoider(&scene, &HERE);
        let beside = [ball(place, false)];
        let obstacles = DynamicObstacles { objects: &beside, robots: &[] };
        let tick = |avoider: &mut Avoider<'_>| avoider.tick(DT, &resting_at(&HERE), &obstacles, 1.0).unwrap();
        let is_pushed = (0..1_500).any(|_| tick(&mut avoider).path_deviation_s > 1e-3 && avoider.is_stationary());
        if !is_pushed {
            continue;
        }
        let detour = avoider.plan_detour(&HERE, &RrtConnectSettings::default(), None).unwrap();
        // Planning takes 1 s.
        for _ in 0..250 {
            avoider.await_detour();
            tick(&mut avoider);
        }
        avoider.follow_detour(detour).unwrap();
        let arrives = (0..1_000).any(|_| tick(&mut avoider).path_deviation_s < 1e-6);
        assert!(arrives, "ball at {place:?}: {:?}", avoider.q());
        followed += 1;
    }
}

#[test]
fn a_detour_does_not_start_elsewhere() {
    let scene = scene();
    let detour_after = |drift_s: f64| {
        let mut avoider = avoider(&scene, &HERE);
        let tick = |avoider: &mut Avoider<'_>, to: &[f64]| {
            avoider.tick(DT, &resting_at(to), &DynamicObstacles::default(), 1.0).unwrap()
        };
        tick(&mut avoider, &HERE);
        let detour = avoider.plan_detour(&THERE, &RrtConnectSettings::default(), None).unwrap();
        let to = [HERE[0] + drift_s * limits(&scene)[0].velocity, HERE[1], HERE[2]];
        for _ in 0..200 {
            tick(&mut avoider, &to);
        }
        assert_eq!(avoider.q(), to);
        let followed = avoider.follow_detour(detour);
        (0..2_000).for_each(|_| _ = tick(&mut avoider, &THERE));
        followed.map(|()| assert_eq!(avoider.q(), THERE))
    };
    assert_eq!(detour_after(5e-4), Ok(()));
    assert_eq!(detour_after(5e-3), Err(AvoidanceError::NotStationary));
}

#[test]
fn a_neighbour_without_velocities_is_refused() {
    let scene = example::two_arms();
    let limits = JointLimits::of_chain(&scene.robots()[0].robot.chain, 0.25, 0.1, 2.0);
    let (own, other) = ([0.0, 0.7, 0.2], [0.0, -1.2, -0.3]);
    let mut avoider =
        Avoider::new(&scene, RobotId(0), &own, &limits, Rules::default(), AvoiderSettings::default()).unwrap();
    for qd in [&[0.0][..], &[], &[f64::NAN, 0.0, 0.0], &[1.0, 0.0, 0.0, 5.0], &[f64::INFINITY, 0.0, 0.0]] {
        let robots = [Neighbour { robot: RobotId(1), q: &other, qd, known: false }];
        let error =
            avoider.tick(DT, &resting_at(&own), &DynamicObstacles { objects: &[], robots: &robots }, 1.0).unwrap_err();
        assert!(matches!(error, AvoidanceError::Neighbour { joints: 3, .. }), "{error}");
        assert_eq!((avoider.q(), avoider.qd()), (&own[..], &[0.0; 3][..]));
    }
}

#[test]
fn after_a_failed_tick_the_robot_returns_without_a_jump() {
    let scene = scene();
    let mut avoider = common::avoider(&scene, &HERE);
    let none = DynamicObstacles::default();
    avoider.tick(DT, &resting_at(&HERE), &none, 1.0).unwrap();
    let nan = [ball(at(f64::NAN, 0.0, 0.0), false)];
    assert!(avoider.tick(DT, &resting_at(&HERE), &DynamicObstacles { objects: &nan, robots: &[] }, 1.0).is_err());
    // The robot's program advanced in the meantime.
    let on = [-0.7, 0.9, 0.6];
    for n in 0..2_000 {
        let before = avoider.q().to_vec();
        avoider.tick(DT, &resting_at(&on), &none, 1.0).unwrap();
        let step = (avoider.q()[0] - before[0]).abs();
        assert!(step <= DT * limits(&scene)[0].velocity, "tick {n}: {step} rad");
    }
    assert_eq!(avoider.q(), on);
}

#[test]
fn braking_near_a_limit_reports_the_actual_velocity() {
    let scene = scene();
    let mut random = Random(3);
    let mut stopped = 0;
    for _ in 0..100 {
        let mut uneven = limits(&scene);
        for (limit, rate) in uneven.iter_mut().zip([8.0, 8.0, 80.0]) {
            (limit.acceleration, limit.stop) = (rate, rate);
        }
        let start = [0.0, random.between(0.5, 0.9), random.between(1.6, 2.45)];
        let mut avoider =
            Avoider::new(&scene, RobotId(0), &start, &uneven, Rules::default(), AvoiderSettings::default()).unwrap();
        let angle = random.between(-3.0, 3.0);
        let velocity = at(angle.cos(), angle.sin(), random.between(-0.5, 0.5));
        let through = at(random.between(0.2, 0.7), random.between(-0.1, 0.1), random.between(0.2, 0.6));
        let stop = random.between(0.4, 1.3);
        for n in 0..400 {
            let t = f64::from(n) * DT;
            let observed_ball = ObservedObject {
                motion: FrameMotion { velocity, ..FrameMotion::REST },
                ..ball(through + velocity * (t - 1.0), false)
            };
            let before = (avoider.q().to_vec(), avoider.qd().to_vec());
            let allowed = if t > stop { 0.0 } else { 1.0 };
            avoider
                .tick(DT, &resting_at(&start), &DynamicObstacles { objects: &[observed_ball], robots: &[] }, allowed)
                .unwrap();
            for (j, limit) in uneven.iter().enumerate() {
                let moved = avoider.q()[j] - before.0[j];
                if avoider.q() != start {
                    assert!((moved - avoider.qd()[j] * DT).abs() < 1e-9, "joint {j} at {t}");
                }
                if allowed == 0.0 {
                    let rate = (avoider.qd()[j] - before.1[j]).abs() / DT;
                    assert!(rate <= limit.stop * (1.0 + 1e-6), "joint {j} at {t}: {rate} of {}", limit.stop);
                    stopped += usize::from(before.1[j].abs() > 0.1);
                }
            }
        }
    }
    assert!(stopped > 100, "{stopped}");
}
