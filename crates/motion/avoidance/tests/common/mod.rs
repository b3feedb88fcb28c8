//! A three-joint arm, a table, and two balls as dynamic obstacles.
#![allow(dead_code)]

use elbowroom_avoidance::{
    Avoider, AvoiderOutput, AvoiderSettings, DynamicObstacles, ObservedObject, PathKind, Reference, Rules,
};
use elbowroom_kinematics::JointLimits;
use elbowroom_planner::RrtConnectSettings;
use elbowroom_proximity::ccd::ConstantTwist;
use elbowroom_proximity::{Cuboid, Shape, Sphere};
use elbowroom_robot::{ObjectId, RobotId, example};
use elbowroom_scene::{Checker, CheckerOptions, Object, Scene, SceneState, Selection, SweepMove, SweepOptions};
use elbowroom_spatial::{FrameMotion, Pose, Vec3};

pub const DT: f64 = 0.004;
/// Time between plans, s: planning fails while an obstacle is in the way.
const PLAN_INTERVAL_S: f64 = 0.5;
/// Largest number of validated states of a plan.
const PLAN_STATES: u64 = 40_000;
/// Radius of a ball, m.
pub const BALL: f64 = 0.08;

/// Object 0 is a known low table, objects 1 and 2 are balls.
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

pub fn limits(scene: &Scene) -> Vec<JointLimits> {
    JointLimits::of_chain(&scene.robots()[0].robot.chain, 0.25, 0.1, 2.0)
}

pub fn avoider<'s>(scene: &'s Scene, q: &[f64]) -> Avoider<'s> {
    Avoider::new(scene, RobotId(0), q, &limits(scene), Rules::default(), AvoiderSettings::default()).unwrap()
}

/// A ball that moves straight until it stops.
#[derive(Debug, Clone, Copy)]
pub struct Ball {
    pub object: ObjectId,
    pub from: Vec3,
    pub velocity: Vec3,
    pub stops_s: f64,
}

impl Ball {
    pub fn observed(&self, t: f64) -> ObservedObject {
        let at = self.from + self.velocity * t.min(self.stops_s);
        let velocity = if t < self.stops_s { self.velocity } else { Vec3::ZERO };
        ObservedObject {
            object: self.object,
            in_world: Pose::from_translation(at),
            motion: FrameMotion { velocity, ..FrameMotion::REST },
            known: false,
        }
    }
}

/// Configuration and velocity of a path at path time.
pub type Path<'a> = &'a dyn Fn(f64) -> (Vec<f64>, Vec<f64>);

/// One run: the path advances at the rate of the output, and a sweep checks every step.
pub struct Simulation<'s> {
    pub scene: &'s Scene,
    pub avoider: Avoider<'s>,
    checker: Checker<'s>,
    state: SceneState,
    pub t: f64,
    pub tau: f64,
    pub rate: f64,
    /// Times of the hits that the sweeps found.
    pub hits: Vec<f64>,
    /// Times of the reversals of each joint.
    pub reversals: Vec<Vec<f64>>,
    sign: Vec<f64>,
    /// Largest commanded speed, as a fraction of the top speed.
    pub max_speed: f64,
    pub output: AvoiderOutput,
    /// Number of planned detours.
    pub planned: usize,
    /// Time of the next plan, s.
    not_before_s: f64,
    /// [`Reference::speed_share`] of the path.
    pub speed_share: f64,
}

impl<'s> Simulation<'s> {
    pub fn new(scene: &'s Scene, q: &[f64]) -> Self {
        Self::with(scene, q, avoider(scene, q))
    }

    /// Creates a simulation with an avoider with other settings.
    pub fn with(scene: &'s Scene, q: &[f64], avoider: Avoider<'s>) -> Self {
        Self {
            scene,
            avoider,
            checker: Checker::new(scene, CheckerOptions::default()),
            state: SceneState::new(scene),
            t: 0.0,
            tau: 0.0,
            rate: 1.0,
            hits: Vec::new(),
            reversals: vec![Vec::new(); q.len()],
            sign: vec![0.0; q.len()],
            max_speed: 0.0,
            output: AvoiderOutput::default(),
            planned: 0,
            not_before_s: 0.0,
            speed_share: 1.0,
        }
    }

    pub fn step(&mut self, reference_at: Path, path: PathKind, balls: &[Ball], speed_override: f64) -> AvoiderOutput {
        let before = self.avoider.q().to_vec();
        let observed: Vec<ObservedObject> = balls.iter().map(|b| b.observed(self.t)).collect();
        self.tau += self.rate * DT * speed_override;
        let (q, qd) = reference_at(self.tau);
        let obstacles = DynamicObstacles { objects: &observed, robots: &[] };
        let reference = Reference { q: &q, qd: &qd, speed_share: self.speed_share, path };
        let output = self.avoider.tick(DT, &reference, &obstacles, speed_override).unwrap();
        self.rate = output.rate.clamp(self.rate - DT / 0.1, self.rate + DT / 0.25).clamp(0.0, 1.0);
        self.record_hits(&before, &observed);
        self.record_command();
        self.t += DT;
        self.output = output;
        output
    }

    /// Plans a detour to `goal` if one is requested, with the work limit and interval of a run.
    pub fn plan(&mut self, goal: &[f64]) -> bool {
        if !self.output.requests_detour || self.t < self.not_before_s {
            return false;
        }
        self.not_before_s = self.t + PLAN_INTERVAL_S;
        let options = |clearance_m| RrtConnectSettings {
            clearance_m,
            max_states: PLAN_STATES,
            time_limit: std::time::Duration::from_mins(1),
            ..RrtConnectSettings::default()
        };
        let planned =
            self.avoider.plan_to(goal, &options(0.06)).is_ok() || self.avoider.plan_to(goal, &options(0.0)).is_ok();
        self.planned += usize::from(planned);
        planned
    }

    fn record_hits(&mut self, before: &[f64], observed: &[ObservedObject]) {
        self.state.set_q(self.scene, RobotId(0), before).unwrap();
        let to = self.avoider.q().to_vec();
        let paths: Vec<ConstantTwist> =
            observed.iter().map(|s| ConstantTwist::from_motion(s.in_world, &s.motion, DT)).collect();
        let mut moves = vec![SweepMove::Robot { robot: RobotId(0), to: &to }];
        moves.extend(observed.iter().zip(&paths).map(|(s, path)| SweepMove::Object { object: s.object, path }));
        let hit = self.checker.between(Selection::Robot(RobotId(0)), Selection::All).sweep(
            &self.state,
            &moves,
            &SweepOptions::default(),
        );
        if hit.unwrap().is_some() {
            self.hits.push(self.t);
        }
    }

    fn record_command(&mut self) {
        for (j, limit) in limits(self.scene).iter().enumerate() {
            let (q, v) = (self.avoider.q()[j], self.avoider.qd()[j]);
            assert!(q >= limit.lower && q <= limit.upper, "joint {j} at {q}");
            self.max_speed = self.max_speed.max(v.abs() / limit.velocity);
            if v.abs() > 1e-4 * limit.velocity {
                if self.sign[j] * v < 0.0 {
                    self.reversals[j].push(self.t);
                }
                self.sign[j] = v.signum();
            }
        }
    }

    /// Shortest time between two reversals of a joint, s.
    pub fn min_reversal_interval(&self) -> f64 {
        let intervals = self.reversals.iter().flat_map(|t| t.windows(2).map(|w| w[1] - w[0]));
        intervals.fold(f64::INFINITY, f64::min)
    }
}
