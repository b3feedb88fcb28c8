//! A three-joint arm, a table, and a ball or two that come.
#![allow(dead_code)]

use elbowroom_avoidance::{Advice, Around, Avoider, AvoiderSettings, JointLimit, PathKind, Reference, Rules, Seen};
use elbowroom_planner::RouteOptions;
use elbowroom_proximity::impact::Steady;
use elbowroom_proximity::{Cuboid, Shape, Sphere};
use elbowroom_scene::{Checker, Move, Object, Options, Scene, SceneState, Selection, SweepOptions, example};
use elbowroom_spatial::{Motion, Pose, Vec3};

pub const DT: f64 = 0.004;
/// Radius of a ball, m.
pub const BALL: f64 = 0.08;

/// Object 0 is a low table that is known, 1 and 2 are balls.
pub fn scene() -> Scene {
    let mut builder = Scene::builder();
    builder.robot("arm", example::arm().unwrap(), Pose::IDENTITY);
    let table = Shape::Cuboid(Cuboid { half_extents: Vec3::new(0.15, 0.5, 0.05) });
    builder.object(Object {
        name: "table".into(),
        shape: table,
        in_world: Pose::from_translation(Vec3::new(0.6, 0.0, 0.0)),
    });
    for name in ["ball", "other"] {
        let shape = Shape::Sphere(Sphere { radius: BALL });
        let in_world = Pose::from_translation(Vec3::new(9.0, 9.0, 9.0));
        builder.object(Object { name: name.into(), shape, in_world });
    }
    builder.build().unwrap()
}

pub fn limits(scene: &Scene) -> Vec<JointLimit> {
    JointLimit::of(&scene.robots()[0].robot.chain, 0.25, 0.1, 2.0)
}

pub fn avoider<'s>(scene: &'s Scene, q: &[f64]) -> Avoider<'s> {
    Avoider::new(scene, 0, q, &limits(scene), Rules::default(), AvoiderSettings::default()).unwrap()
}

/// A ball that flies straight until it stops.
#[derive(Debug, Clone, Copy)]
pub struct Ball {
    pub object: usize,
    pub from: Vec3,
    pub velocity: Vec3,
    pub stops_s: f64,
}

impl Ball {
    pub fn seen(&self, t: f64) -> Seen {
        let at = self.from + self.velocity * t.min(self.stops_s);
        let velocity = if t < self.stops_s { self.velocity } else { Vec3::ZERO };
        Seen {
            object: self.object,
            in_world: Pose::from_translation(at),
            motion: Motion { velocity, ..Motion::REST },
            known: false,
        }
    }
}

/// What a path wants at a time of its own, with its velocity.
pub type Course<'a> = &'a dyn Fn(f64) -> (Vec<f64>, Vec<f64>);

/// One run: the path at the rate that the advice allows, every step judged by a sweep.
pub struct Stage<'s> {
    pub scene: &'s Scene,
    pub avoider: Avoider<'s>,
    judge: Checker<'s>,
    state: SceneState,
    pub t: f64,
    pub tau: f64,
    pub rate: f64,
    /// Contacts that the judge saw: when.
    pub hits: Vec<f64>,
    /// Times at which each joint turned back.
    pub turns: Vec<Vec<f64>>,
    sign: Vec<f64>,
    /// Largest share of a joint's speed that was commanded.
    pub fastest: f64,
    pub advice: Advice,
    /// Ways that were planned.
    pub planned: usize,
}

impl<'s> Stage<'s> {
    pub fn new(scene: &'s Scene, q: &[f64]) -> Self {
        Self {
            scene,
            avoider: avoider(scene, q),
            judge: Checker::new(scene, Options::default()),
            state: SceneState::new(scene),
            t: 0.0,
            tau: 0.0,
            rate: 1.0,
            hits: Vec::new(),
            turns: vec![Vec::new(); q.len()],
            sign: vec![0.0; q.len()],
            fastest: 0.0,
            advice: Advice::default(),
            planned: 0,
        }
    }

    pub fn step(&mut self, course: Course, path: PathKind, balls: &[Ball], speed_override: f64) -> Advice {
        let before = self.avoider.q().to_vec();
        let seen: Vec<Seen> = balls.iter().map(|b| b.seen(self.t)).collect();
        self.tau += self.rate * DT * speed_override;
        let (q, qd) = course(self.tau);
        let around = Around { objects: &seen, robots: &[] };
        let advice = self.avoider.tick(DT, &Reference { q: &q, qd: &qd, path }, &around, speed_override).unwrap();
        self.rate = advice.rate.clamp(self.rate - DT / 0.1, self.rate + DT / 0.25).clamp(0.0, 1.0);
        self.judge(&before, &seen);
        self.note();
        self.t += DT;
        self.advice = advice;
        advice
    }

    /// Another way to `goal` where the arm does not get on.
    pub fn plan(&mut self, goal: &[f64]) -> bool {
        if !self.advice.wants_way {
            return false;
        }
        let options = |clearance_m| RouteOptions { clearance_m, ..RouteOptions::default() };
        let planned =
            self.avoider.plan_to(goal, &options(0.06)).is_ok() || self.avoider.plan_to(goal, &options(0.0)).is_ok();
        self.planned += usize::from(planned);
        planned
    }

    fn judge(&mut self, before: &[f64], seen: &[Seen]) {
        self.state.set_q(self.scene, 0, before).unwrap();
        let to = self.avoider.q().to_vec();
        let paths: Vec<Steady> = seen.iter().map(|s| Steady::from_motion(s.in_world, &s.motion, DT)).collect();
        let mut moves = vec![Move::Robot { robot: 0, to: &to }];
        moves.extend(seen.iter().zip(&paths).map(|(s, path)| Move::Object { object: s.object, path }));
        let hit = self.judge.between(Selection::Robot(0), Selection::All).sweep(
            &self.state,
            &moves,
            &SweepOptions::default(),
        );
        if hit.unwrap().is_some() {
            self.hits.push(self.t);
        }
    }

    fn note(&mut self) {
        for (j, limit) in limits(self.scene).iter().enumerate() {
            let (q, v) = (self.avoider.q()[j], self.avoider.qd()[j]);
            assert!(q >= limit.lower && q <= limit.upper, "joint {j} at {q}");
            self.fastest = self.fastest.max(v.abs() / limit.speed);
            if v.abs() > 1e-4 * limit.speed {
                if self.sign[j] * v < 0.0 {
                    self.turns[j].push(self.t);
                }
                self.sign[j] = v.signum();
            }
        }
    }

    /// Shortest time between two reversals of a joint, s.
    pub fn quietest(&self) -> f64 {
        let gaps = self.turns.iter().flat_map(|t| t.windows(2).map(|w| w[1] - w[0]));
        gaps.fold(f64::INFINITY, f64::min)
    }
}

/// A pseudo-random sequence.
pub struct Random(pub u64);

impl Random {
    pub fn range(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
}
