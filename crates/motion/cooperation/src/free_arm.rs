//! The motion of an arm without the work-piece: towards where it waits, out of the way of everything.

use elbowroom_avoidance::LeastSquares;
use elbowroom_kinematics::{ChainState, JointLimits, LinkId};
use elbowroom_robot::{GeometryId, RobotId};
use elbowroom_scene::{ApproachingPair, Checker, LevelOfDetail, Scene, SceneMotion, SceneState, Selection};
use elbowroom_spatial::{Pose, Vec3};

use crate::CooperationSettings;

/// Most pairs that an arm keeps away from at the same time.
const ROWS: usize = 16;
/// Distance beyond the gap from which a pair is always looked at, m.
const NOTICE_M: f64 = 0.005;
/// Time until contact within which a pair is measured exactly, s.
const EXACT_S: f64 = 0.05;
/// Speed from which a pair is noticed in time for its gap, m/s; slower ones are near when they count.
const SLOW_M_S: f64 = 0.2;
/// Largest speed at which two parts are expected to approach each other, m/s.
const FASTEST_M_S: f64 = 2.0;
/// Distance between its own links from which an arm keeps them apart, m.
const SELF_NOTICE_M: f64 = 0.005;
/// Distance between its own links that an arm keeps, m.
const SELF_GAP_M: f64 = 0.002;
/// Weight of the repulsion against the attraction.
const REPULSION: f64 = 1e4;
/// Share of the deceleration that the boundary distance counts on.
const DECELERATION_SHARE: f64 = 0.5;
/// Time in which an arm that is too near moves away by as much as is missing, s.
const RECOVERY_S: f64 = 0.1;
/// Speed along a distance that an arm gives up from which it is said to yield, m/s.
const YIELDS_M_S: f64 = 0.01;
/// Time after the last push in which an arm is still said to yield, s: pushes come and go while two arms move past each other.
const YIELDS_ON_S: f64 = 0.5;

/// Where an arm is and how it moves, for the others.
#[derive(Debug)]
pub(crate) struct ArmMotion {
    pub robot: RobotId,
    /// Joint values and velocities, with the poses and motions of the links.
    pub state: ChainState,
    pub base_in_world: Pose,
}

impl ArmMotion {
    /// Velocity of the point of a link that is at a place in the world, m/s.
    fn velocity(&self, link: LinkId, in_world: Vec3) -> Vec3 {
        let in_root = self.base_in_world.inverse_transform_point(in_world);
        self.base_in_world.transform_vector(self.state.point_velocity(link, in_root))
    }
}

/// What draws a free arm.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Attraction<'a> {
    /// Where it wants to be.
    pub q: &'a [f64],
    /// How fast that place moves, rad/s or m/s.
    pub velocity: Option<&'a [f64]>,
}

/// The solver of a free arm.
#[derive(Debug)]
pub(crate) struct FreeArm {
    limits: Vec<JointLimits>,
    problem: LeastSquares,
    /// Pairs that are near, and the gap that the arm keeps, m.
    pairs: Vec<(ApproachingPair, f64)>,
    columns: Vec<[f64; 6]>,
    other_columns: Vec<[f64; 6]>,
    /// Joint velocities of the result, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Time left in which it is said to yield, s.
    yields_s: f64,
}

impl FreeArm {
    pub fn new(limits: &[JointLimits]) -> Self {
        let n = limits.len();
        Self {
            limits: limits.to_vec(),
            problem: LeastSquares::new(n, ROWS),
            pairs: Vec::with_capacity(ROWS),
            columns: vec![[0.0; 6]; n],
            other_columns: vec![[0.0; 6]; n],
            velocity: vec![0.0; n],
            yields_s: 0.0,
        }
    }

    /// Whether something pushes the arm, or did a moment ago.
    pub fn is_yielding(&self) -> bool {
        self.yields_s > 0.0
    }

    /// The arm had to stand, or to go home.
    pub fn gives_way(&mut self) {
        self.yields_s = YIELDS_ON_S;
    }

    /// The arm has the work-piece, and is not free.
    pub fn carries(&mut self) {
        self.yields_s = 0.0;
    }

    /// Finds the joint velocities of the arm `own` among `arms` for `dt_s` seconds.
    ///
    /// It moves towards its attraction. Towards anything else it never moves faster than it can stop before the gap: the
    /// distance from which that slows it down is the boundary distance of the requirement, `v²/(2·a)` with the closing
    /// speed v and what the joints can decelerate along the line between the nearest points, a.
    pub fn react(
        &mut self,
        (scene, state, checker): (&Scene, &SceneState, &mut Checker<'_>),
        (arms, motion, own): (&[ArmMotion], &SceneMotion, usize),
        attraction: Attraction<'_>,
        settings: &CooperationSettings,
        dt_s: f64,
    ) {
        self.attract(&arms[own].state, attraction, dt_s);
        let notice_s = self.notice_s(arms, dt_s, settings.gap_m);
        self.notice((scene, state, checker), motion, arms[own].robot, (notice_s, settings.gap_m));
        self.problem.clear();
        let pairs = std::mem::take(&mut self.pairs);
        for (pair, gap_m) in &pairs {
            self.repel(scene, (arms, own), state, (pair, *gap_m));
        }
        self.pairs = pairs;
        let mut x = std::mem::take(&mut self.velocity);
        if !self.problem.solve(&mut x) {
            x.fill(0.0);
        }
        let is_pushed = self.problem.constraints().iter().any(|row| {
            let wanted: f64 = row.a.iter().zip(&self.problem.desired).map(|(a, v)| a * v).sum();
            row.b - wanted > YIELDS_M_S
        });
        self.yields_s = if is_pushed { YIELDS_ON_S } else { (self.yields_s - dt_s).max(0.0) };
        self.velocity = x;
    }

    /// Desired velocities and their bounds: speed, acceleration, and what still stops before the limit of a joint.
    fn attract(&mut self, own: &ChainState, attraction: Attraction<'_>, dt_s: f64) {
        let problem = &mut self.problem;
        for (j, l) in self.limits.iter().enumerate() {
            let (q, qd) = (own.q[j], own.qd[j]);
            let drift = attraction.velocity.map_or(0.0, |v| v[j]);
            let error = attraction.q[j] - q;
            let towards = (l.acceleration * error.abs()).sqrt().min(error.abs() / (2.0 * dt_s)).copysign(error);
            problem.desired[j] = (drift + towards).clamp(-l.velocity, l.velocity);
            let stop = |room: f64| (2.0 * l.acceleration * room.max(0.0)).sqrt().min(room.max(0.0) / dt_s);
            let (lower, upper) = (-l.velocity.min(stop(q - l.lower)), l.velocity.min(stop(l.upper - q)));
            problem.lower[j] = lower.max(qd - l.acceleration * dt_s).min(upper);
            problem.upper[j] = upper.min(qd + l.acceleration * dt_s).max(problem.lower[j]);
            self.velocity[j] = qd;
        }
    }

    /// Time until contact from which a pair is of no interest, s.
    ///
    /// Along any direction, the ratio of what the joints move and what they can decelerate is at most the longest time T in
    /// which one of them stops, so the boundary distance `v²/(2·a)` is at most `v·T/2`, and as much again for what the other
    /// arms move, as far as they are like this one; and the gap.
    fn notice_s(&self, arms: &[ArmMotion], dt_s: f64, gap_m: f64) -> f64 {
        let stop_s = |arm: &ArmMotion| {
            let joints = arm.state.qd.iter().zip(&self.limits);
            let stops =
                joints.map(|(qd, l)| (qd.abs() + l.acceleration * dt_s) / (l.acceleration * DECELERATION_SHARE));
            stops.fold(0.0, f64::max)
        };
        dt_s + gap_m / SLOW_M_S + 0.5 * arms.iter().map(stop_s).sum::<f64>()
    }

    /// The nearest pairs between the arm and everything, with the gap of each, m.
    fn notice(
        &mut self,
        (scene, state, checker): (&Scene, &SceneState, &mut Checker<'_>),
        motion: &SceneMotion,
        own: RobotId,
        (notice_s, gap_m): (f64, f64),
    ) {
        let pairs = &mut self.pairs;
        pairs.clear();
        let mut add = |pair: ApproachingPair, gap_m: f64| {
            if pairs.len() < ROWS {
                pairs.push((pair, gap_m));
            } else if let Some(farthest) = pairs.iter_mut().max_by(|a, b| a.0.metres.total_cmp(&b.0.metres))
                && pair.metres < farthest.0.metres
            {
                *farthest = (pair, gap_m);
            }
        };
        // What is farther away counts only if it may meet soon, and with the distance of boxes unless that is very soon.
        let policy = |near_m: f64| LevelOfDetail {
            exact_m: near_m,
            exact_s: EXACT_S,
            within_m: near_m + FASTEST_M_S * notice_s,
            progressive: true,
        };
        let counts = |pair: &ApproachingPair, near_m: f64| pair.metres <= near_m || pair.earliest_s < notice_s;
        let arm = Selection::Robot(own);
        checker.between(arm, arm).approaching(state, motion, &policy(SELF_NOTICE_M), notice_s, |pair| {
            if counts(&pair, SELF_NOTICE_M) {
                add(pair, SELF_GAP_M);
            }
        });
        let near_m = gap_m + NOTICE_M;
        let others = (0..scene.robots().len()).map(RobotId).filter(|other| *other != own).map(Selection::Robot);
        for other in others.chain([Selection::Objects]) {
            let is_carried = |id: GeometryId| matches!(id, GeometryId::Object(o) if state.attachment(o).is_some());
            checker.between(arm, other).approaching(state, motion, &policy(near_m), notice_s, |pair| {
                // What a robot carries belongs to the robot.
                let is_twice = other == Selection::Objects && (is_carried(pair.a) || is_carried(pair.b));
                if counts(&pair, near_m) && !is_twice {
                    add(pair, gap_m);
                }
            });
        }
    }

    /// Adds the repulsion of a pair.
    fn repel(
        &mut self,
        scene: &Scene,
        (arms, own): (&[ArmMotion], usize),
        state: &SceneState,
        (pair, gap_m): (&ApproachingPair, f64),
    ) {
        let (arm, chain) = (&arms[own], &scene.robots()[arms[own].robot.0].robot.chain);
        let link_of = |id: GeometryId| match id {
            GeometryId::Link { robot, link } => Some((robot, link)),
            GeometryId::Object(object) => state.attachment(object).map(|a| (a.robot, a.link)),
        };
        let is_own = |id| link_of(id).is_some_and(|(robot, _)| robot == arm.robot);
        let (mine, on_mine, other, on_other) = if is_own(pair.a) {
            (pair.a, pair.on_a, pair.b, pair.on_b)
        } else {
            (pair.b, pair.on_b, pair.a, pair.on_a)
        };
        let (Some((_, link)), Some(normal)) = (link_of(mine), (on_mine - on_other).try_normalize()) else { return };
        let in_root = arm.base_in_world.inverse_transform_vector(normal);
        let in_link = |link: LinkId, p: Vec3| {
            let link_in_world = arm.base_in_world * arm.state.link_in_root(link);
            link_in_world.inverse_transform_point(p)
        };
        chain.jacobian(&arm.state, link, in_link(link, on_mine), &mut self.columns);
        let mut leaves_at = 0.0;
        match link_of(other) {
            Some((robot, link)) if robot == arm.robot => {
                chain.jacobian(&arm.state, link, in_link(link, on_other), &mut self.other_columns);
                for (column, other) in self.columns.iter_mut().zip(&self.other_columns) {
                    column.iter_mut().zip(other).for_each(|(a, b)| *a -= b);
                }
            }
            Some((robot, link)) => {
                let moving = arms.iter().find(|arm| arm.robot == robot);
                leaves_at = moving.map_or(0.0, |arm| normal.dot(arm.velocity(link, on_other)));
            }
            None => {}
        }
        let Some(row) = self.problem.add_constraint() else { return };
        let mut deceleration = 0.0;
        for ((a, column), limits) in row.a.iter_mut().zip(&self.columns).zip(&self.limits) {
            *a = in_root.dot(Vec3::new(column[0], column[1], column[2]));
            deceleration += a.abs() * limits.acceleration * DECELERATION_SHARE;
        }
        let room_m = pair.metres - gap_m;
        let closing = if room_m > 0.0 { (2.0 * deceleration * room_m).sqrt() } else { room_m / RECOVERY_S };
        row.b = leaves_at - closing;
        (row.weight, row.at_least) = (REPULSION, true);
    }
}
