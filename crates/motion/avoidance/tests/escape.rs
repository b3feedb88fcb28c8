//! Escapes from fast obstacles, and borders that are kept.

use crate::common::{Ball, DT, Simulation, limits, scene};
use elbowroom_avoidance::{
    Avoider, AvoiderSettings, DynamicObstacles, EscapeSettings, EscapeState, PathKind, Reference, Rules,
    search_escape_tree,
};
use elbowroom_kinematics::ChainState;
use elbowroom_planner::PathConstraint;
use elbowroom_robot::{ObjectId, RobotId, example};
use elbowroom_spatial::Vec3;
use elbowroom_testkit::random::Random;

const LEAN: [f64; 3] = [0.0, 0.9, 0.6];

/// A ball shot from afar towards a point near the arm.
fn shot(random: &mut Random) -> Ball {
    let about = random.between(-3.1, 3.1);
    let climb = random.between(-0.3, 0.3);
    let along = Vec3::new(about.cos() * f64::cos(climb), about.sin() * f64::cos(climb), f64::sin(climb));
    let through = Vec3::new(random.between(0.35, 0.9), random.between(-0.3, 0.3), random.between(0.3, 0.8));
    let speed = random.between(0.8, 3.0);
    Ball { object: ObjectId(1), from: through - along * 2.5, velocity: along * speed, stops_s: f64::INFINITY }
}

struct Outcome {
    /// State of the joints over time.
    states: Vec<[Vec<f64>; 2]>,
    hit_s: Option<f64>,
    escaped: bool,
    min_reversal_s: f64,
}

fn run(scene: &elbowroom_scene::Scene, ball: Ball, horizon_s: f64) -> Outcome {
    let escape = EscapeSettings { horizon_s, ..EscapeSettings::default() };
    let settings = AvoiderSettings { escape, ..AvoiderSettings::default() };
    let mut simulation = Simulation::new(scene, &LEAN);
    simulation.avoider = Avoider::new(scene, RobotId(0), &LEAN, &limits(scene), Rules::default(), settings).unwrap();
    let (mut states, mut escaped) = (Vec::new(), false);
    let mut acceleration = 0.0_f64;
    for _ in 0..700 {
        states.push([simulation.avoider.q().to_vec(), simulation.avoider.qd().to_vec()]);
        let output = simulation.step(&|_| (LEAN.to_vec(), vec![0.0; 3]), PathKind::PointToPoint, &[ball], 1.0);
        escaped |= output.escape == EscapeState::Escaping;
        for (qdd, limit) in simulation.avoider.qdd().iter().zip(limits(scene)) {
            acceleration = acceleration.max(qdd.abs() / limit.stop);
        }
        if !simulation.hits.is_empty() {
            break;
        }
    }
    assert!(simulation.max_speed <= 1.0 + 1e-9 && acceleration <= 1.0 + 1e-6, "{acceleration}");
    let min_reversal_s = simulation.min_reversal_interval();
    Outcome { states, hit_s: simulation.hits.first().copied(), escaped, min_reversal_s }
}

#[test]
fn what_still_hits_is_inescapable() {
    let scene = scene();
    let mut random = Random(11);
    let (mut without, mut with, mut escaped) = (0, 0, 0);
    for shot_number in 0..150 {
        let ball = shot(&mut random);
        without += usize::from(run(&scene, ball, 0.0).hit_s.is_some());
        let outcome = run(&scene, ball, 3.0);
        escaped += usize::from(outcome.escaped);
        assert!(outcome.min_reversal_s >= 0.25 - 1e-9, "shot {shot_number}: {}", outcome.min_reversal_s);
        let Some(hit_s) = outcome.hit_s else { continue };
        with += 1;
        // An independent search in space and time from one second before.
        let before = ((hit_s - 1.0).max(0.0) / DT) as usize;
        let [q, qd] = &outcome.states[before];
        let objects = [ball.observed(before as f64 * DT)];
        let obstacles = DynamicObstacles { objects: &objects, robots: &[] };
        let mut numbers = Random(5);
        let found =
            search_escape_tree(&scene, RobotId(0), &limits(&scene), [q, qd], &obstacles, 2.0, 2_000, &mut || {
                numbers.between(0.0, 1.0)
            })
            .unwrap();
        assert_eq!(found.gap_m, None, "shot {shot_number} was escapable");
    }
    println!("{without} hit without escapes, {with} with them; {escaped} escaped");
    assert!(escaped > 2 && with <= without && without > 5, "{without} {with} {escaped}");
}

#[test]
fn the_work_of_a_tick_is_bounded_and_counted_alike_in_every_run() {
    let scene = scene();
    let tight_us: u32 = 600;
    let ball = shot(&mut Random(5));
    let work = |work_us: u32| {
        let escape = EscapeSettings { work_us, ..EscapeSettings::default() };
        let settings = AvoiderSettings { escape, ..AvoiderSettings::default() };
        let mut simulation = Simulation::new(&scene, &LEAN);
        simulation.avoider =
            Avoider::new(&scene, RobotId(0), &LEAN, &limits(&scene), Rules::default(), settings).unwrap();
        let mut step = || {
            let output = simulation.step(&|_| (LEAN.to_vec(), vec![0.0; 3]), PathKind::PointToPoint, &[ball], 1.0);
            (output.escape, output.escape_work_us)
        };
        (0..600).map(|_| step()).collect::<Vec<_>>()
    };
    let most = |ticks: &[(EscapeState, u64)]| ticks.iter().map(|t| t.1).max().unwrap();
    let (free, tight) = (work(1_000_000), work(tight_us));
    // A stop is always checked, and if it is free, nothing else is computed; a query that has begun is finished.
    let stop = most(&work(0));
    let searching: Vec<(EscapeState, u64)> = tight.iter().copied().filter(|t| t.0 != EscapeState::Free).collect();
    assert!(most(&searching) <= u64::from(tight_us).max(stop) + 150, "{} {stop}", most(&searching));
    assert!(most(&free) > most(&searching) + 150, "{} {}", most(&free), most(&searching));
    // With less work per tick an escape is also found, but later.
    assert!(tight.iter().any(|t| t.0 == EscapeState::Known) && !work(0).iter().any(|t| t.0 == EscapeState::Known));
    assert_eq!(work(tight_us), tight);
}

#[test]
fn the_search_in_space_and_time_tells_what_can_be_escaped() {
    let scene = scene();
    let search = |from: Vec3, velocity: Vec3| {
        let ball = Ball { object: ObjectId(1), from, velocity, stops_s: f64::INFINITY };
        let objects = [ball.observed(0.0)];
        let obstacles = DynamicObstacles { objects: &objects, robots: &[] };
        let mut numbers = Random(3);
        let start = [&LEAN[..], &[0.0; 3]];
        search_escape_tree(&scene, RobotId(0), &limits(&scene), start, &obstacles, 2.5, 500, &mut || {
            numbers.between(0.0, 1.0)
        })
        .unwrap()
    };
    // Through the pedestal, which no joint moves.
    let pedestal = search(Vec3::new(0.0, -1.0, 0.1), Vec3::new(0.0, 1.0, 0.0));
    assert_eq!((pedestal.gap_m, pedestal.tries), (None, 500));
    assert!(pedestal.longest_s < 1.0);
    // Through the forearm in 1.2 s: the arm turns away.
    let forearm = search(Vec3::new(0.6, -1.2, 0.62), Vec3::new(0.0, 1.0, 0.0));
    assert!(forearm.gap_m.is_some_and(|gap| gap > 0.0) && forearm.longest_s == 2.5, "{forearm:?}");
    // Too fast for the arm to escape.
    assert_eq!(search(Vec3::new(0.6, -1.2, 0.62), Vec3::new(0.0, 60.0, 0.0)).gap_m, None);
    // Far away: no escape is needed.
    assert!(search(Vec3::new(6.0, -1.2, 0.5), Vec3::new(0.0, 1.0, 0.0)).gap_m.is_some_and(|gap| gap > 3.0));
}

/// Keeps the end of the forearm on one side of a plane.
#[derive(Debug)]
struct Wall {
    robot: elbowroom_robot::Robot,
    state: ChainState,
    normal: Vec3,
    /// Position of the plane along its normal, m.
    at: f64,
}

impl Wall {
    fn new(normal: Vec3, at: f64) -> Self {
        let robot = example::arm().unwrap();
        Self { state: ChainState::new(&robot.chain), robot, normal, at }
    }

    /// Position of the end of the forearm along the normal, m.
    fn along(&mut self, q: &[f64]) -> f64 {
        self.state.q.copy_from_slice(q);
        self.robot.chain.forward(&mut self.state);
        let end = self.state.link_in_root(self.robot.chain.tip()).transform_point(Vec3::Z * 0.35);
        end.dot(self.normal)
    }
}

impl PathConstraint for Wall {
    fn distance_m(&mut self, q: &[f64], _: f64) -> f64 {
        self.at - self.along(q)
    }

    fn motion_bound_m(&mut self, from: &[f64], to: &[f64]) -> f64 {
        from.iter().zip(to).map(|(a, b)| (a - b).abs()).sum()
    }

    fn describe_nearest(&mut self, _: &[f64]) -> String {
        "the wall".into()
    }
}

/// Distance by which the end of the forearm moves along a direction while a ball passes.
fn excursion(horizon_s: f64, normal: Vec3, wall_m: Option<f64>) -> f64 {
    let scene = scene();
    let escape = EscapeSettings { horizon_s, ..EscapeSettings::default() };
    let settings = AvoiderSettings { escape, ..AvoiderSettings::default() };
    let mut avoider = Avoider::new(&scene, RobotId(0), &LEAN, &limits(&scene), Rules::default(), settings).unwrap();
    let from = Vec3::new(0.6, -1.5, 0.62);
    let ball = Ball { object: ObjectId(1), from, velocity: Vec3::new(0.0, 0.9, 0.0), stops_s: f64::INFINITY };
    let mut measured = Wall::new(normal, 0.0);
    let start = measured.along(&LEAN);
    let mut wall = wall_m.map(|m| Wall::new(normal, start + m));
    let mut farthest = 0.0_f64;
    for tick in 0..700 {
        let objects = [ball.observed(f64::from(tick) * DT)];
        let reference = Reference { q: &LEAN, qd: &[0.0; 3], speed_share: 1.0, path: PathKind::PointToPoint };
        let obstacles = DynamicObstacles { objects: &objects, robots: &[] };
        let constraint = wall.as_mut().map(|w| w as &mut dyn PathConstraint);
        avoider.tick_constrained(DT, &reference, &obstacles, 1.0, constraint).unwrap();
        farthest = farthest.max(measured.along(avoider.q()) - start);
    }
    farthest
}

#[test]
fn neither_the_rules_nor_an_escape_cross_a_border() {
    for horizon_s in [0.0, 3.0] {
        let all = [Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y, Vec3::Z, -Vec3::Z];
        let free = all.map(|normal| (excursion(horizon_s, normal, None), normal));
        let (free, normal) = free.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        assert!(free > 0.05, "the arm yields to the ball: {free}");
        let wall = 0.6 * free;
        let kept = excursion(horizon_s, normal, Some(wall));
        assert!(kept <= wall + 1e-3, "{kept} beyond {wall} with a horizon of {horizon_s} s");
    }
}
