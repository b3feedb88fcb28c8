//! The reactive controller: computes an evading joint velocity from a desired joint velocity and the proximity pairs.
//!
//! Each pair adds two rows to a weighted least-squares problem in the joint velocities ([`LeastSquares`]):
//! - **evade** (dynamic obstacles): the collision point moves in the direction of the correction of the fuzzy rules, at
//!   least at the speed of the correction, `u·J·q̇ ≥ size·V`;
//! - **keep clear** (all obstacles): the distance decreases no faster than a stop allows, `ḋ ≥ −(d − d_min)/τ`
//!   (Faverjon and Tournassoud 1987, "A local based approach for path planning of manipulators with a high number of
//!   degrees of freedom").
//!
//! A border ([`Border`]) adds one row of the second kind: joints move towards a region no faster than a stop allows.
//!
//! The remaining degrees of freedom follow the desired velocity: motion beyond the task is minimal in the norm of the joints'
//! top speeds, and the null space belongs to the task.

use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_spatial::Vec3;

use crate::least_squares::{LeastSquares, SoftConstraint};
use crate::side_selector::{ApproachingObstacle, SideSelector};
use crate::{Border, ObstacleKind, ProximityPair, Rules, VelocityBounds};

/// Largest number of proximity pairs that count, nearest pairs first.
pub(crate) const MAX_PAIRS: usize = 48;
/// Weight of an evasion of size 1; the task has the weight 1.
const EVADE_WEIGHT: f64 = 100.0;
/// Weight of keeping clear: a desired full speed violates it by a millionth of the evasion speed.
const KEEP_CLEAR_WEIGHT: f64 = 1e6;
/// Weight of a border: a monitor stops the robot at a border, so crossing it would not help to keep clear.
const BORDER_WEIGHT: f64 = 1e8;
/// Speed below which a motion has no defined direction, m/s.
const STATIONARY_M_S: f64 = 0.02;
/// Speed of approach from which an obstacle is fully evaded even by a robot that keeps its path, m/s.
const FULL_EVASION_M_S: f64 = 0.05;

/// Smallest speed of the collision point with all joints at full speed that counts, m/s: the effort stays finite in a
/// direction in which the point hardly moves.
const MIN_POINT_SPEED_M_S: f64 = 1e-3;

/// Settings of the reactive controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReactiveSettings {
    /// Speed of the collision point for a correction of size 1, m/s.
    pub speed_m_s: f64,
    /// Clearance from dynamic obstacles, m.
    pub clearance_m: f64,
    /// Distance from known obstacles below which the robot, off its path, does not approach, m.
    pub fixed_clearance_m: f64,
    /// Time constant of a decreasing distance, s: at least the duration of a stop.
    pub closing_s: f64,
}

impl Default for ReactiveSettings {
    /// 1 m/s; 50 mm and 20 mm; 0.2 s.
    fn default() -> Self {
        Self { speed_m_s: 1.0, clearance_m: 0.05, fixed_clearance_m: 0.02, closing_s: 0.2 }
    }
}

/// The purpose of the desired velocity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Along a path that may be left: the approach speed of an obstacle includes the robot's own motion.
    Transit,
    /// Back to a path: the approach speed does not include the robot's own motion.
    Return,
    /// Along a path that must be kept: only obstacles that approach by their own motion are evaded. For the other
    /// obstacles the caller slows down.
    KeepPath,
    /// Along a detour that was checked against all stationary obstacles: only moving obstacles count.
    Detour,
}

/// The task without obstacles.
#[derive(Debug, Clone, Copy)]
pub struct VelocityTask<'a> {
    /// Desired joint velocities, rad/s or m/s.
    pub desired: &'a [f64],
    /// Bounds of the joint velocities.
    pub bounds: &'a VelocityBounds,
    /// The purpose of the desired velocity.
    pub mode: Mode,
    /// False if all moving dynamic obstacles are predicted to pass: the rules then count only obstacles at rest.
    /// Distances are kept in any case.
    pub is_on_collision_course: bool,
}

/// Summary of a reaction.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reaction {
    /// Largest size of a correction, 0 to 1.
    pub size: f64,
    /// Index of the pair that requests this correction.
    pub governing: Option<usize>,
    /// Largest violation of keeping clear, m/s; above 0, an obstacle approaches faster than the robot can move away.
    pub overrun_m_s: f64,
    /// Whether the desired velocity violates a constraint of an obstacle that may move.
    pub is_active: bool,
}

/// The reactive controller of one robot. It allocates only when it is created.
#[derive(Debug, Clone)]
pub struct ReactiveController {
    rules: Rules,
    settings: ReactiveSettings,
    /// Top speed per joint, rad/s or m/s.
    speeds: Vec<f64>,
    solver: LeastSquares,
    sides: SideSelector,
    columns: Vec<[f64; 6]>,
    other_columns: Vec<[f64; 6]>,
    /// Velocity of the collision point per joint at its top speed, m/s.
    point: Vec<Vec3>,
    /// Joint velocities as fractions of the top speeds.
    scaled: Vec<f64>,
}

impl ReactiveController {
    /// Creates a controller for a chain with these top speeds (rad/s or m/s, positive, one per independent joint).
    pub fn new(chain: &Chain, speeds: &[f64], rules: Rules, settings: ReactiveSettings) -> Self {
        let n = chain.dof();
        let mut speeds = speeds.to_vec();
        speeds.resize(n, 1.0);
        Self {
            rules,
            settings,
            speeds,
            solver: LeastSquares::new(n, 2 * MAX_PAIRS + 1),
            sides: SideSelector::default(),
            columns: vec![[0.0; 6]; n],
            other_columns: vec![[0.0; 6]; n],
            point: vec![Vec3::ZERO; n],
            scaled: vec![0.0; n],
        }
    }

    /// The rules.
    pub fn rules(&self) -> &Rules {
        &self.rules
    }

    /// Writes the evading joint velocity to `out`. `state` holds the present poses of the links. Only the first 48
    /// pairs count, so sort them by distance.
    pub fn react(
        &mut self,
        chain: &Chain,
        state: &ChainState,
        task: &VelocityTask<'_>,
        pairs: &[ProximityPair],
        out: &mut [f64],
    ) -> Reaction {
        self.react_within(chain, state, task, pairs, None, out)
    }

    /// Like [`react`](Self::react), within a border.
    pub fn react_within(
        &mut self,
        chain: &Chain,
        state: &ChainState,
        task: &VelocityTask<'_>,
        pairs: &[ProximityPair],
        border: Option<Border<'_>>,
        out: &mut [f64],
    ) -> Reaction {
        let VelocityTask { desired, bounds, .. } = *task;
        self.sides.begin_tick();
        self.solver.clear();
        for (j, speed) in self.speeds.iter().enumerate() {
            self.solver.desired[j] = desired[j] / speed;
            self.solver.lower[j] = bounds.next[j][0] / speed;
            self.solver.upper[j] = bounds.next[j][1] / speed;
            self.scaled[j] = self.solver.desired[j];
        }
        let mut reaction = Reaction::default();
        for (index, pair) in pairs.iter().enumerate().take(MAX_PAIRS) {
            if task.mode == Mode::Detour && pair.obstacle_velocity().length() <= STATIONARY_M_S {
                continue;
            }
            self.update_point(chain, state, pair);
            let first = self.solver.constraints().len();
            self.keep_clear(pair);
            let size = self.evade(pair, task);
            let counts = match pair.obstacle {
                ObstacleKind::Dynamic { .. } => true,
                // The path was planned with the obstacle.
                ObstacleKind::KnownMoving { .. } => matches!(task.mode, Mode::Detour | Mode::Return),
                ObstacleKind::OwnLink(_) | ObstacleKind::Fixed => false,
            };
            if counts {
                let is_violated = |c: &SoftConstraint| !(c.weight == 0.0 || c.residual(&self.scaled) == 0.0);
                reaction.is_active |= self.solver.constraints()[first..].iter().any(is_violated);
            }
            if size > reaction.size {
                (reaction.size, reaction.governing) = (size, Some(index));
            }
        }
        if let Some(border) = border {
            self.keep_within(&border);
        }
        if !self.solver.solve(&mut self.scaled) {
            // Without a finite solution, the velocity is as low as the bounds permit.
            out.iter_mut().zip(&bounds.next).for_each(|(v, [low, high])| *v = 0.0_f64.clamp(*low, *high));
            return Reaction { is_active: true, ..reaction };
        }
        for (j, speed) in self.speeds.iter().enumerate() {
            out[j] = self.scaled[j] * speed;
        }
        reaction.overrun_m_s = self.overrun();
        reaction
    }

    /// Updates the velocity of the collision point per joint; relative to the other link for a pair of own links.
    fn update_point(&mut self, chain: &Chain, state: &ChainState, pair: &ProximityPair) {
        point_jacobian(chain, state, pair.link, pair.on_link, &mut self.columns);
        if let ObstacleKind::OwnLink(link) = pair.obstacle {
            point_jacobian(chain, state, link, pair.on_obstacle, &mut self.other_columns);
        } else {
            self.other_columns.fill([0.0; 6]);
        }
        for (j, point) in self.point.iter_mut().enumerate() {
            let (a, b) = (&self.columns[j], &self.other_columns[j]);
            *point = Vec3::new(a[0] - b[0], a[1] - b[1], a[2] - b[2]) * self.speeds[j];
        }
    }

    fn keep_clear(&mut self, pair: &ProximityPair) {
        let s = &self.settings;
        let is_dynamic = pair.obstacle.is_dynamic();
        let free = pair.distance_m - if is_dynamic { s.clearance_m } else { s.fixed_clearance_m };
        // The robot does not move away from known obstacles: there may be no space on the other side.
        let closing = if is_dynamic { free } else { free.max(0.0) } / s.closing_s;
        let b = (pair.away.dot(pair.obstacle_velocity()) - closing) / s.speed_m_s;
        self.add_constraint(pair.away, b, KEEP_CLEAR_WEIGHT);
    }

    /// Adds the constraint that the margin to a border decreases no faster than a stop allows.
    fn keep_within(&mut self, border: &Border<'_>) {
        let s = self.settings;
        let Some(constraint) = self.solver.add_constraint() else { return };
        for (a, (slope, speed)) in constraint.a.iter_mut().zip(border.gradient.iter().zip(&self.speeds)) {
            *a = slope * speed / s.speed_m_s;
        }
        // A robot nearer than the margin does not move away: its way may lead along the border.
        constraint.b = -border.margin_m.max(0.0) / s.closing_s / s.speed_m_s;
        (constraint.weight, constraint.at_least) = (BORDER_WEIGHT, true);
    }

    /// Adds the correction of the rules and returns its size.
    fn evade(&mut self, pair: &ProximityPair, task: &VelocityTask<'_>) -> f64 {
        let VelocityTask { desired, bounds, mode, is_on_collision_course } = *task;
        let ObstacleKind::Dynamic { velocity, centre, radius_m, key } = pair.obstacle else { return 0.0 };
        if !is_on_collision_course && velocity.length() > STATIONARY_M_S {
            return 0.0;
        }
        let by_task = self.point.iter().zip(desired).zip(&self.speeds).map(|((p, w), s)| *p * (w / s));
        let own = by_task.fold(Vec3::ZERO, |sum, v| sum + v);
        let relative = if mode == Mode::Transit { velocity - own } else { velocity };
        let mut correction = self.rules.correction(pair.distance_m, pair.away.dot(relative));
        if mode == Mode::KeepPath {
            correction.size *= (pair.away.dot(velocity) / FULL_EVASION_M_S).clamp(0.0, 1.0);
        }
        if correction.size <= 0.0 {
            return 0.0;
        }
        let mut direction = pair.away;
        // The obstacle's own velocity is steadier than its velocity relative to a moving arm.
        let approach = if velocity.length() > STATIONARY_M_S { velocity } else { relative };
        if let Some(along) = approach.try_normalize().filter(|_| approach.length() > STATIONARY_M_S) {
            let from_centre = pair.on_link - centre;
            let offset = from_centre - along * from_centre.dot(along);
            let clearance_m = radius_m + self.settings.clearance_m;
            let side = self.side(&ApproachingObstacle { direction: along, offset, clearance_m, key }, bounds);
            let (s, c) = correction.direction_rad.sin_cos();
            direction = (pair.away * c + side * s).try_normalize().unwrap_or(side);
        }
        self.add_constraint(direction, correction.size, EVADE_WEIGHT * correction.size);
        correction.size
    }

    fn side(&mut self, obstacle: &ApproachingObstacle, bounds: &VelocityBounds) -> Vec3 {
        let (point, speeds) = (&self.point, &self.speeds);
        let max_speed = |side: Vec3| {
            let each = point.iter().zip(&bounds.stoppable).zip(speeds).map(|((p, [low, high]), s)| {
                let along = p.dot(side) / s;
                (along * low).max(along * high)
            });
            each.sum::<f64>()
        };
        let effort = |side: Vec3| {
            let square: f64 = point.iter().map(|p| p.dot(side).powi(2)).sum();
            1.0 / square.sqrt().max(MIN_POINT_SPEED_M_S)
        };
        self.sides.select(obstacle, max_speed, effort)
    }

    /// Adds the constraint that the collision point moves along `direction` at least at `b` times the evasion speed.
    fn add_constraint(&mut self, direction: Vec3, b: f64, weight: f64) {
        let Some(constraint) = self.solver.add_constraint() else { return };
        for (a, p) in constraint.a.iter_mut().zip(&self.point) {
            *a = p.dot(direction) / self.settings.speed_m_s;
        }
        (constraint.b, constraint.weight, constraint.at_least) = (b, weight, true);
    }

    fn overrun(&self) -> f64 {
        let keep_clear = self.solver.constraints().iter().filter(|c| c.weight == KEEP_CLEAR_WEIGHT);
        keep_clear.map(|c| -c.residual(&self.scaled)).fold(0.0, f64::max) * self.settings.speed_m_s
    }
}

/// Jacobian columns of the point of a link that is at `point_in_root`.
fn point_jacobian(chain: &Chain, state: &ChainState, link: LinkId, point_in_root: Vec3, out: &mut [[f64; 6]]) {
    let in_link = state.link_in_root(link).inverse().transform_point(point_in_root);
    chain.jacobian(state, link, in_link, out);
}
