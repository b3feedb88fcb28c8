//! The control loop: sense, correct, check, command.

mod command_check;
mod conclusion;
mod detours;

use std::time::Instant;

use elbowroom_kinematics::JointLimits;
use elbowroom_planner::PathConstraint;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Attachment, Scene, SceneError};

use crate::border::BorderQuery;
use crate::detour::JointState;
use crate::escape_search::EscapeSearch;
use crate::joint_command::JointCommand;
use crate::joint_limits::{arrival_speed, brake, distance_s, problem, progress, speed_fraction, stop_s, update_bounds};
use crate::objective::Objective;
use crate::proximity_query::{ProximityQuery, ProximityRange};
use crate::reversal_limiter::ReversalLimiter;
use crate::state_machine::StateMachine;
use crate::sweep_check::SweepCheck;
use crate::{
    AvoidanceError, AvoiderOutput, AvoiderSettings, DynamicObstacles, EscapeState, Reaction, ReactiveController,
    Reference, Rules, StageTimes, VelocityBounds, VelocityTask,
};

/// Override below which the robot is stopped.
const MIN_OVERRIDE: f64 = 1e-6;
/// Fraction of the desired velocity below which the robot makes no progress.
const MIN_PROGRESS: f64 = 0.15;
/// Fraction of the top speed below which the robot is stationary.
const STATIONARY_FRACTION: f64 = 5e-3;
/// Time constant of the return to the path shortly after a correction, s: a faster return would work against the evasion.
const GENTLE_RETURN_S: f64 = 0.15;
/// Range within which fixed obstacles are found, as a multiple of the distance at which they limit an evasion (evasion
/// speed times the time constant of the controller): the excess is a reserve for the next ticks.
const FIXED_RANGE_FACTOR: f64 = 1.5;

/// Makes one robot of a scene avoid dynamic obstacles and return to its path.
///
/// The path belongs to the caller: in each tick the reference is the next point of the path, advanced at the rate of
/// the last output. If no obstacle is near, the command equals the reference.
#[derive(Debug)]
pub struct Avoider<'s> {
    query: ProximityQuery<'s>,
    controller: ReactiveController,
    sweep: SweepCheck,
    escapes: EscapeSearch<'s>,
    border: BorderQuery,
    reversals: ReversalLimiter,
    limits: Vec<JointLimits>,
    settings: AvoiderSettings,
    command: JointCommand,
    workspace: Workspace,
    machine: StateMachine,
}

/// A detour that is planned but not yet followed.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedDetour {
    /// Start of the detour, rad or m.
    start_q: Vec<f64>,
    waypoints: Vec<Vec<f64>>,
}

/// Memory of one tick.
#[derive(Debug)]
struct Workspace {
    bounds: VelocityBounds,
    desired: Vec<f64>,
    next: Vec<f64>,
    braked: Vec<f64>,
    max_next: Vec<f64>,
    columns: Vec<[f64; 6]>,
}

/// A correction of the desired velocity.
struct Correction {
    reaction: Reaction,
    /// Remaining fraction of the desired velocity.
    progress: f64,
    /// Whether the next command is exactly the reference.
    is_reference: bool,
    /// Whether a stop after the correction hits nothing fixed and no known moving obstacle.
    can_stop: bool,
    /// Whether the correction was replaced by braking.
    is_braked: bool,
}

impl<'s> Avoider<'s> {
    /// Creates an avoider for a robot of a scene, at rest at `q`. `limits` has one entry per independent joint.
    ///
    /// # Errors
    /// The robot does not exist, joint values or limits are invalid, or their number is wrong.
    pub fn new(
        scene: &'s Scene,
        robot: RobotId,
        q: &[f64],
        limits: &[JointLimits],
        rules: Rules,
        settings: AvoiderSettings,
    ) -> Result<Self, AvoidanceError> {
        let count = scene.robots().len();
        let chain = &scene.robots().get(robot.0).ok_or(SceneError::NoSuchRobot { index: robot.0, count })?.robot.chain;
        let mut query = ProximityQuery::new(scene, robot);
        query.update_scene(q, &DynamicObstacles::default())?;
        let n = chain.dof();
        if limits.len() != n {
            return Err(AvoidanceError::Limits { given: limits.len(), joints: n });
        }
        if let Some((joint, what)) = limits.iter().enumerate().find_map(|(j, l)| Some((j, problem(l)?))) {
            return Err(AvoidanceError::Limit { joint, what });
        }
        let limits = limits.to_vec();
        let speeds: Vec<f64> = limits.iter().map(|l| l.velocity).collect();
        // A distance must not decrease faster than a stop allows.
        let mut settings = settings;
        settings.reactive.closing_s = settings.reactive.closing_s.max(stop_s(&limits, &speeds));
        let zeros = || vec![0.0; n];
        Ok(Self {
            controller: ReactiveController::new(chain, &speeds, rules, settings.reactive),
            sweep: SweepCheck::new(scene, settings.escape.work_us),
            escapes: EscapeSearch::new(scene, robot, q, settings.escape),
            border: BorderQuery::new(n),
            query,
            reversals: ReversalLimiter::new(n, settings.min_reversal_interval_s),
            machine: StateMachine::new(settings.stall_timeout_s),
            settings,
            limits,
            command: JointCommand::at_rest(q),
            workspace: Workspace {
                bounds: VelocityBounds { next: vec![[0.0; 2]; n], stoppable: vec![[0.0; 2]; n] },
                desired: zeros(),
                next: zeros(),
                braked: zeros(),
                max_next: zeros(),
                columns: vec![[0.0; 6]; n],
            },
        })
    }

    /// Attaches an object of the scene to a link of this or another robot. The object then avoids obstacles like the
    /// link, also in detours. Do not list it among the observed objects until it is detached.
    ///
    /// # Errors
    /// The errors of [`SceneState::attach_at`](elbowroom_scene::SceneState::attach_at).
    pub fn attach(&mut self, object: ObjectId, attachment: Attachment) -> Result<(), AvoidanceError> {
        self.query.attach(object, attachment.clone())?;
        Ok(self.escapes.attach(object, attachment)?)
    }

    /// Detaches an object, which becomes an obstacle again at its present pose.
    ///
    /// # Errors
    /// The object is not attached.
    pub fn detach(&mut self, object: ObjectId) -> Result<(), AvoidanceError> {
        let in_world = self.query.detach(object)?;
        Ok(self.escapes.detach(object, in_world)?)
    }

    /// The commanded joint values, rad or m.
    pub fn q(&self) -> &[f64] {
        &self.command.q
    }

    /// The commanded joint velocities, rad/s or m/s.
    pub fn qd(&self) -> &[f64] {
        &self.command.qd
    }

    /// The commanded joint accelerations, rad/s² or m/s².
    pub fn qdd(&self) -> &[f64] {
        &self.command.qdd
    }

    /// The joint velocities at override 1, rad/s or m/s, for a monitor with the direction-aware law.
    pub fn intent(&self) -> &[f64] {
        &self.command.intent
    }

    /// Whether the robot is slow enough to start a detour.
    pub fn is_stationary(&self) -> bool {
        speed_fraction(&self.command.qd, &self.limits) < STATIONARY_FRACTION
    }

    /// Whether the robot follows a detour.
    pub fn has_detour(&self) -> bool {
        self.machine.has_detour()
    }

    /// Computes one tick of `dt` seconds. `reference` is the path at the end of the tick, `obstacles` the present
    /// observations, and `speed_override` (0 to 1) the override of a monitor, which scales the corrected motion.
    ///
    /// # Errors
    /// Poses, motions or joint values are missing or not finite, or the duration is not positive. Then stop the robot:
    /// the next tick starts at rest at the last command and returns to the path.
    pub fn tick(
        &mut self,
        dt: f64,
        reference: &Reference<'_>,
        obstacles: &DynamicObstacles<'_>,
        speed_override: f64,
    ) -> Result<AvoiderOutput, AvoidanceError> {
        self.tick_constrained(dt, reference, obstacles, speed_override, None)
    }

    /// Like [`tick`](Self::tick), with a constraint on motion off the path, such as regions in which a monitor stops
    /// the robot: the border of the constraint is a row of the least squares, and escapes keep the constraint.
    ///
    /// # Errors
    /// The errors of [`tick`](Self::tick).
    pub fn tick_constrained(
        &mut self,
        dt: f64,
        reference: &Reference<'_>,
        obstacles: &DynamicObstacles<'_>,
        speed_override: f64,
        mut constraint: Option<&mut dyn PathConstraint>,
    ) -> Result<AvoiderOutput, AvoidanceError> {
        let valid = self.check_call(dt, reference);
        let begin = Instant::now();
        if let Err(error) = valid.and_then(|()| self.query.update_scene(&self.command.q, obstacles)) {
            self.machine.fail();
            self.escapes.reset();
            self.command.stop();
            return Err(error);
        }
        self.find_pairs(dt, obstacles);
        let sensed = Instant::now();
        let allowed = if speed_override >= MIN_OVERRIDE { speed_override.min(1.0) } else { 0.0 };
        let objective = Objective::of(self.machine.state());
        let border = constraint.as_mut().map(|c| &mut **c as &mut dyn PathConstraint);
        let mut correction = self.correct(dt, reference, allowed, objective, border);
        let corrected = Instant::now();
        if !correction.is_reference {
            self.check(dt, reference, obstacles, objective, &mut correction);
        }
        let checked = Instant::now();
        let escape = self.keep_escape(dt, reference, obstacles, allowed, constraint, &mut correction);
        let escaped = Instant::now();
        let reference_q = correction.is_reference.then_some(reference.q);
        self.command.advance(dt, &self.workspace.next, &self.limits, reference_q);
        self.reversals.record(&self.command.qd, self.limits.iter().map(|l| l.velocity), dt);
        let times = StageTimes {
            sense: sensed - begin,
            correct: corrected - sensed,
            check: checked - corrected,
            escape: escaped - checked,
        };
        let braked = correction.is_braked && escape != EscapeState::Escaping;
        let escape_work_us = self.escapes.work_us();
        let output = AvoiderOutput {
            reaction: correction.reaction,
            braked,
            escape,
            escape_work_us,
            times,
            ..AvoiderOutput::default()
        };
        Ok(self.conclude(dt, reference, allowed, correction.progress, output))
    }

    fn check_call(&self, dt: f64, reference: &Reference<'_>) -> Result<(), AvoidanceError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(AvoidanceError::TickDuration(dt));
        }
        let joints = self.command.q.len();
        let is_valid = |v: &[f64]| v.len() == joints && v.iter().all(|v| v.is_finite());
        if is_valid(reference.q) && is_valid(reference.qd) && reference.speed_share.is_finite() {
            return Ok(());
        }
        Err(AvoidanceError::Reference { given: reference.q.len().min(reference.qd.len()), joints })
    }

    fn find_pairs(&mut self, dt: f64, obstacles: &DynamicObstacles<'_>) {
        let max_next = &mut self.workspace.max_next;
        for (max, (v, limit)) in max_next.iter_mut().zip(self.command.qd.iter().zip(&self.limits)) {
            *max = (v.abs() + limit.stop * dt).min(limit.velocity);
        }
        let ahead_s = 2.0 * dt + 0.5 * stop_s(&self.limits, max_next);
        // Fixed obstacles matter within a stop from the fastest next command and within the range of an evasion.
        let s = &self.settings.reactive;
        let nearby_m = s.fixed_clearance_m + FIXED_RANGE_FACTOR * s.closing_s * s.speed_m_s;
        let fixed_m = nearby_m.max(self.query.own_motion_bounds().max_travel(max_next, ahead_s));
        let range = ProximityRange { dynamic_m: self.controller.rules().reach_m(), fixed_m, ahead_s };
        self.query.find_pairs(obstacles, range);
    }

    /// Writes the next velocity to the workspace.
    fn correct(
        &mut self,
        dt: f64,
        reference: &Reference<'_>,
        allowed: f64,
        objective: Objective,
        constraint: Option<&mut dyn PathConstraint>,
    ) -> Correction {
        self.update_bounds(dt);
        self.update_desired(dt, reference, allowed, objective);
        if allowed == 0.0 {
            return self.stop(dt, reference, objective);
        }
        self.reversals.restrict(&mut self.workspace.bounds);
        let Workspace { bounds, desired, next, .. } = &mut self.workspace;
        for (next, stoppable) in bounds.next.iter_mut().zip(&bounds.stoppable) {
            // The override later scales everything except the position limits.
            *next = next.map(|v| (v / allowed).clamp(stoppable[0], stoppable[1]));
        }
        let ProximityQuery { scene, robot, chains, pairs, .. } = &self.query;
        let (chain, state) = (&scene.robots()[robot.0].robot.chain, &chains[robot.0]);
        let is_on_collision_course = self.escapes.is_on_collision_course();
        let task = VelocityTask { desired, bounds, mode: objective.mode(reference), is_on_collision_course };
        let s = &self.settings.reactive;
        let reach_m = FIXED_RANGE_FACTOR * s.closing_s * s.speed_m_s;
        let border = match constraint {
            // Without an obstacle the robot follows a motion that was planned with the border.
            Some(c) if pairs.iter().any(|p| p.obstacle.may_move()) => self.border.near(c, &self.command.q, reach_m),
            _ => None,
        };
        let reaction = self.controller.react_within(chain, state, &task, pairs, border, next);
        let progress = progress(next, desired, &self.limits);
        self.command.intent.copy_from_slice(next);
        let is_resting = reaction.overrun_m_s <= 0.0
            && ((self.is_stalled() && progress < MIN_PROGRESS)
                || (self.machine.awaits_detour() && self.is_by_obstacle_at_rest(&reaction)));
        // The override widened the bounds; the scaled command must keep the original ones.
        self.update_bounds(dt);
        self.reversals.restrict(&mut self.workspace.bounds);
        let Workspace { bounds, desired, next, .. } = &mut self.workspace;
        for (v, [low, high]) in next.iter_mut().zip(&bounds.next) {
            *v = (*v * allowed).clamp(*low, *high);
        }
        match objective {
            _ if reaction.is_active && !is_resting => self.machine.abandon_detour(),
            Objective::Path if !is_resting => self.follow_reference(dt, reference),
            Objective::Detour => next.iter_mut().zip(desired).for_each(|(v, w)| *v = *w * allowed),
            Objective::Rest => self.brake(dt),
            // The robot is trapped, or a detour is being planned from here: rest instead of creeping.
            _ if is_resting => self.brake(dt),
            _ => {}
        }
        let is_reference = objective == Objective::Path && !reaction.is_active && !is_resting;
        Correction { reaction, progress, is_reference, can_stop: true, is_braked: false }
    }

    /// Writes the next velocity of a robot that may not move.
    fn stop(&mut self, dt: f64, reference: &Reference<'_>, objective: Objective) -> Correction {
        self.command.intent.fill(0.0);
        // A robot on its path stops by following it.
        match objective {
            Objective::Path => self.follow_reference(dt, reference),
            _ => self.brake(dt),
        }
        let is_reference = objective == Objective::Path;
        Correction { reaction: Reaction::default(), progress: 1.0, is_reference, can_stop: true, is_braked: false }
    }

    fn update_bounds(&mut self, dt: f64) {
        update_bounds(&mut self.workspace.bounds, &self.limits, &self.command.q, &self.command.qd, dt);
    }

    /// Writes the velocity that leads to the reference to `next`.
    fn follow_reference(&mut self, dt: f64, reference: &Reference<'_>) {
        for ((v, to), from) in self.workspace.next.iter_mut().zip(reference.q).zip(&self.command.q) {
            *v = (to - from) / dt;
        }
    }

    /// Writes the velocity of a stop to `next`.
    fn brake(&mut self, dt: f64) {
        let Workspace { bounds, next, .. } = &mut self.workspace;
        brake(&self.limits, &bounds.stoppable, &self.command.qd, dt, next);
    }

    /// Writes the velocity towards the objective, at override 1, to `desired`.
    fn update_desired(&mut self, dt: f64, reference: &Reference<'_>, allowed: f64, objective: Objective) {
        let scale = allowed.max(MIN_OVERRIDE);
        let most = self.settings.return_speed(reference.speed_share);
        let desired = &mut self.workspace.desired;
        match objective {
            Objective::Path => {
                for ((v, to), from) in desired.iter_mut().zip(reference.q).zip(&self.command.q) {
                    *v = (to - from) / (dt * scale);
                }
            }
            Objective::Rest => desired.fill(0.0),
            Objective::Detour => {
                let now = JointState { q: &self.command.q, qd: &self.command.qd, limits: &self.limits };
                if let Some(detour) = self.machine.detour_mut() {
                    detour.follow(dt, most * allowed, &now, &self.reversals, desired);
                }
                for v in desired.iter_mut() {
                    *v /= scale;
                }
            }
            Objective::Return { gently } => {
                let remaining_s = distance_s(reference.q, &self.command.q, &self.limits);
                let rise_s = self.limits.iter().map(|l| l.velocity / l.acceleration).fold(0.0, f64::max);
                let gentle = if gently { remaining_s / GENTLE_RETURN_S } else { f64::INFINITY };
                let speed = arrival_speed(remaining_s, rise_s).min(most).min(gentle);
                let rate = if remaining_s > 0.0 { (speed / remaining_s).min(1.0 / dt) } else { 0.0 };
                for ((v, to), from) in desired.iter_mut().zip(reference.q).zip(&self.command.q) {
                    *v = (to - from) * rate;
                }
            }
        }
    }
}
