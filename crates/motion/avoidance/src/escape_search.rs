//! Search for escapes: if no escape would remain after the rules' command, the robot follows the known escape instead.
//!
//! If a stop would be hit within the horizon, time-optimal joint motions are sampled ([`escape_targets`]) and proven
//! against the predicted motion of all moving obstacles ([`EscapeCheck`]). The proven motion with the largest gap is
//! kept. The rules command the robot as long as an escape remains after their command. If none would remain, the robot
//! moves on the escape that was proven before (a safety filter in the sense of Fraichard and Asama 2004, "Inevitable
//! collision states").
//!
//! [`escape_targets`]: crate::escape_targets

use elbowroom_planner::PathConstraint;
use elbowroom_robot::{ObjectId, RobotId};
use elbowroom_scene::{Attachment, Scene, SceneError};
use elbowroom_spatial::{Pose, Vec3};

use crate::DynamicObstacles;
use crate::escape_check::{EscapeCheck, EscapeClearance, EscapeMotion, MotionCheck, PredictedHit, moves, robot_moves};
use crate::escape_targets::{EscapeDirections, target};
use crate::escape_trajectory::{EscapeStart, EscapeTrajectory};
use crate::escape_trial::{EscapeCandidate, EscapeTrial};
use crate::escape_work::EscapeWork;
use crate::hit_point::HitPoint;
use crate::known_escape::KnownEscape;

/// A moving obstacle is on a collision course if it comes nearer to a robot that stops now than this many clearances …
const COURSE_CLEARANCES: f64 = 3.0;
/// … and remains so until it keeps this many clearances, so that the decision does not change with every tick.
const PASSING_CLEARANCES: f64 = 4.0;
/// … or, if it is nearer than that now, nearer than this fraction of its present distance …
const COURSE_SHARE: f64 = 0.8;
/// … and in any case while it is nearer than this many clearances.
const NEAR_CLEARANCES: f64 = 2.0;
/// If a stop is free for longer than this time (s), the search pauses …
const UNHURRIED_S: f64 = 1.5;
/// … for this number of ticks.
const PAUSE_TICKS: usize = 3;
/// Number of examined ticks per search for a better escape than the known one.
const IMPROVE_TICKS: usize = 4;
/// Fraction of a tick's work for deciding which obstacles pass: one not proven to pass is on a collision course …
const COURSE_SHARE_OF_WORK: f64 = 0.4;
/// … for deciding what a stop hits: a stop not proven free by then counts as hit …
const STOP_SHARE_OF_WORK: f64 = 0.7;
/// … and for all work before the known escape is proven again, if that is needed.
const FIND_SHARE: f64 = 0.85;
/// Deviation of the robot from the escape, in rad or m, above which it no longer follows it.
const OFF_ESCAPE: f64 = 1e-3;

/// Settings of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EscapeSettings {
    /// Time for which motions are predicted, s. 0: no escapes are sampled.
    pub horizon_s: f64,
    /// Largest number of escapes examined per tick.
    pub per_tick: usize,
    /// Largest computing time of a tick, µs, counted in elementary tests times their measured costs: the count is the
    /// same on every machine and in every run. What is not proven within this time is examined in later ticks; a stop
    /// that is not proven free counts as hit.
    pub work_us: u32,
    /// Clearance of an escape from moving obstacles, m.
    pub clearance_m: f64,
    /// Clearance of an escape from fixed obstacles, m.
    pub fixed_clearance_m: f64,
}

impl Default for EscapeSettings {
    /// 3 s; 3 escapes and 2 ms per tick; 50 mm and 10 mm.
    fn default() -> Self {
        Self { horizon_s: 3.0, per_tick: 3, work_us: 2000, clearance_m: 0.05, fixed_clearance_m: 0.01 }
    }
}

/// Result of the search in a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EscapeState {
    /// A stop is free within the horizon.
    #[default]
    Free,
    /// A stop would be hit, and an escape is known.
    Known,
    /// A stop would be hit, and no escape is known.
    Unknown,
    /// The robot follows an escape.
    Escaping,
}

/// The state before a command.
pub(crate) struct EscapeTick<'a> {
    pub(crate) dt: f64,
    /// The present state of the robot.
    pub(crate) start: EscapeStart<'a>,
    pub(crate) obstacles: &'a DynamicObstacles<'a>,
    /// The point of the path.
    pub(crate) reference_q: &'a [f64],
    /// Whether a stop after the command of the rules hits nothing fixed. On an escape the robot may be faster than the
    /// rules would permit there, because the escape may lead around the obstacle of a stop.
    pub(crate) can_stop: bool,
    /// Present distances of the nearest evaded obstacle and of the nearest fixed obstacle, m.
    pub(crate) nearest: EscapeClearance,
}

/// Samples, proves and follows escapes of one robot.
#[derive(Debug)]
pub(crate) struct EscapeSearch<'s> {
    scene: &'s Scene,
    robot: RobotId,
    settings: EscapeSettings,
    check: EscapeCheck<'s>,
    /// Configuration at the start of the robot's program.
    home_q: Vec<f64>,
    /// State of the robot after the command.
    next: NextState,
    stop: EscapeTrajectory,
    trial: EscapeTrial,
    known: KnownEscape,
    /// Result of the last examined tick, and the number of ticks until the next one.
    state: EscapeState,
    pause: usize,
    course: ObstacleCourse,
    /// Work at the beginning of the tick.
    begin: EscapeWork,
    point: HitPoint,
    rest_q: Vec<f64>,
}

/// Positions (rad or m) and velocities.
#[derive(Debug)]
struct NextState {
    q: Vec<f64>,
    qd: Vec<f64>,
}

/// Result of the last examined tick for all moving obstacles that are evaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ObstacleCourse {
    /// Some obstacle comes near a robot that stops, or this was not excluded.
    Collision,
    /// All obstacles pass.
    Passing,
}

impl<'s> EscapeSearch<'s> {
    pub(crate) fn new(scene: &'s Scene, robot: RobotId, q: &[f64], settings: EscapeSettings) -> Self {
        let n = q.len();
        Self {
            scene,
            robot,
            settings,
            check: EscapeCheck::new(scene, robot),
            home_q: q.to_vec(),
            next: NextState { q: q.to_vec(), qd: vec![0.0; n] },
            stop: EscapeTrajectory::new(n),
            trial: EscapeTrial::new(q),
            known: KnownEscape::new(q),
            state: EscapeState::Free,
            pause: 0,
            course: ObstacleCourse::Collision,
            begin: EscapeWork::default(),
            point: HitPoint::new(&scene.robots()[robot.0].robot.chain),
            rest_q: q.to_vec(),
        }
    }

    /// Attaches an object to a link of any robot. The known escape was proven without the object.
    pub(crate) fn attach(&mut self, object: ObjectId, attachment: Attachment) -> Result<(), SceneError> {
        self.reset();
        self.check.attach(object, attachment)
    }

    /// Detaches an object, which is at `in_world` now.
    pub(crate) fn detach(&mut self, object: ObjectId, in_world: Pose) -> Result<(), SceneError> {
        self.reset();
        self.check.detach(object, in_world)
    }

    /// Forgets all results.
    pub(crate) fn reset(&mut self) {
        self.known.forget();
        (self.state, self.pause) = (EscapeState::Free, 0);
        self.course = ObstacleCourse::Collision;
    }

    /// False if all moving obstacles that are evaded are predicted to pass a robot that stops.
    pub(crate) fn is_on_collision_course(&self) -> bool {
        self.course == ObstacleCourse::Collision
    }

    /// Replaces the next command (rad/s or m/s) by the command of the known escape if no escape would be left after it.
    pub(crate) fn guard(
        &mut self,
        tick: &EscapeTick<'_>,
        mut constraint: Option<&mut dyn PathConstraint>,
        next: &mut [f64],
    ) -> EscapeState {
        self.begin = self.check.work();
        let evaded_moves = tick.obstacles.objects.iter().any(|o| !o.known && moves(o))
            || tick.obstacles.robots.iter().any(|n| !n.known && n.robot != self.robot && robot_moves(n));
        let is_needed = evaded_moves || self.known.followed_s.is_some();
        if self.settings.horizon_s <= 0.0 || !is_needed || tick.start.speed_share <= 0.0 {
            self.reset();
            return EscapeState::Free;
        }
        if self.pause > 0 && self.known.followed_s.is_none() {
            self.pause -= 1;
            self.known.is_fresh = false;
            return self.state;
        }
        // If the scene cannot be checked, no escape is known: the rules remain in command.
        let state = self.examine(tick, &mut constraint, next).unwrap_or(EscapeState::Unknown);
        if state == EscapeState::Free {
            self.known.forget();
        }
        self.state = state;
        // An error was reported above; poses that could be placed before can be placed again.
        let _ = self.check.reset(tick.obstacles);
        state
    }

    fn examine(
        &mut self,
        tick: &EscapeTick<'_>,
        constraint: &mut Option<&mut dyn PathConstraint>,
        next: &mut [f64],
    ) -> Result<EscapeState, SceneError> {
        let clearance = EscapeClearance {
            moving_m: self.settings.clearance_m.min(0.5 * tick.nearest.moving_m),
            fixed_m: self.settings.fixed_clearance_m.min(0.5 * tick.nearest.fixed_m),
        };
        self.set_next(tick, next);
        let hit = self.stop_hit(tick, clearance.moving_m)?;
        let is_unhurried = hit.is_none_or(|hit| hit.time_s > UNHURRIED_S);
        self.pause = if is_unhurried { PAUSE_TICKS } else { 0 };
        self.known.followed_s = self.known.followed_s.filter(|s| self.known.is_proven && self.is_on_escape(tick, *s));
        self.set_deadline(1.0);
        if let Some(followed_s) = self.known.followed_s
            && (hit.is_some() || !tick.can_stop)
        {
            return self.follow(tick, followed_s, hit, clearance, constraint, next);
        }
        let Some(hit) = hit else { return Ok(EscapeState::Free) };
        // The known escape must be proven again if no other is found: reserve its part of the work.
        let has_to_be_proven = self.known.is_proven && !self.known.is_fresh;
        self.set_deadline(if has_to_be_proven { FIND_SHARE } else { 1.0 });
        if self.find(tick, &hit, clearance, constraint)? {
            return Ok(EscapeState::Known);
        }
        self.set_deadline(1.0);
        // The command would lose the last escape: the robot follows that escape.
        self.known.is_proven =
            self.known.is_proven && (self.known.is_fresh || self.is_free_from_now(tick, clearance, constraint)?);
        if self.known.is_proven {
            return self.follow(tick, 0.0, Some(hit), clearance, constraint, next);
        }
        Ok(EscapeState::Unknown)
    }

    /// Work of the last tick, µs.
    pub(crate) fn work_us(&self) -> u64 {
        (self.check.work() - self.begin).us()
    }

    /// Sets the fraction of the tick's work at which checks end.
    fn set_deadline(&mut self, share: f64) {
        let work = EscapeWork::from_us(self.settings.work_us).share(share);
        self.check.set_deadline(self.begin.plus(work));
    }

    /// Moves the beginning of the known escape to the present state; returns whether it is still free.
    fn is_free_from_now(
        &mut self,
        tick: &EscapeTick<'_>,
        clearance: EscapeClearance,
        constraint: &mut Option<&mut dyn PathConstraint>,
    ) -> Result<bool, SceneError> {
        self.known.trajectory.set_target(&self.known.target, &tick.start);
        let horizon_s = self.settings.horizon_s;
        let motion = EscapeMotion { trajectory: &self.known.trajectory, elapsed_s: 0.0, begins_s: 0.0, horizon_s };
        Ok(self.check.meets_moving(&motion, tick.obstacles, clearance.moving_m, |_| true)?.is_free()
            && self.check.keeps_clear_of_fixed(&motion, tick.obstacles, clearance.fixed_m)?
            && constraint.as_deref_mut().is_none_or(|c| self.check.keeps_constraint(&motion, c)))
    }

    /// Sets the state of the robot after a command.
    fn set_next(&mut self, tick: &EscapeTick<'_>, next: &[f64]) {
        for (j, limit) in tick.start.limits.iter().enumerate() {
            self.next.q[j] = (tick.start.q[j] + next[j] * tick.dt).clamp(limit.lower, limit.upper);
            self.next.qd[j] = next[j];
        }
    }

    /// Predicts where a stop meets a moving obstacle (at once, if not all was examined), and whether any obstacle is on
    /// a collision course.
    fn stop_hit(&mut self, tick: &EscapeTick<'_>, clearance_m: f64) -> Result<Option<PredictedHit>, SceneError> {
        let clearances = match std::mem::replace(&mut self.course, ObstacleCourse::Collision) {
            ObstacleCourse::Collision => PASSING_CLEARANCES,
            ObstacleCourse::Passing => COURSE_CLEARANCES,
        };
        let (nearest_m, own_m) = (tick.nearest.moving_m, self.settings.clearance_m);
        let mut from_s = 0.0;
        if nearest_m > NEAR_CLEARANCES * own_m {
            self.set_deadline(COURSE_SHARE_OF_WORK);
            let passing = self.check_stop(tick, 0.0, (clearances * own_m).min(COURSE_SHARE * nearest_m))?;
            if passing.is_free() {
                self.course = ObstacleCourse::Passing;
                return Ok(None);
            }
            // Before an obstacle comes within this distance, none comes within the clearance.
            from_s = passing.hit.filter(|_| passing.is_complete).map_or(0.0, |hit| hit.time_s);
        }
        self.set_deadline(STOP_SHARE_OF_WORK);
        let stop = self.check_stop(tick, from_s, clearance_m)?;
        Ok(stop.hit.map(|hit| PredictedHit { time_s: if stop.is_complete { from_s + hit.time_s } else { 0.0 }, ..hit }))
    }

    /// Checks a stop after the command, from `from_s` on.
    fn check_stop(&mut self, tick: &EscapeTick<'_>, from_s: f64, clearance_m: f64) -> Result<MotionCheck, SceneError> {
        let start = EscapeStart { q: &self.next.q, qd: &self.next.qd, ..tick.start };
        self.stop.set_stop(&start);
        let horizon_s = self.settings.horizon_s - from_s;
        let motion = EscapeMotion { trajectory: &self.stop, elapsed_s: from_s, begins_s: tick.dt + from_s, horizon_s };
        self.check.meets_moving(&motion, tick.obstacles, clearance_m, |known| !known)
    }

    fn is_on_escape(&self, tick: &EscapeTick<'_>, followed_s: f64) -> bool {
        self.known.trajectory.is_near(followed_s, tick.start.q, OFF_ESCAPE)
    }

    /// Continues along the known escape; searches another one if the changed prediction hits it.
    fn follow(
        &mut self,
        tick: &EscapeTick<'_>,
        followed_s: f64,
        stop_hit: Option<PredictedHit>,
        clearance: EscapeClearance,
        constraint: &mut Option<&mut dyn PathConstraint>,
        next: &mut [f64],
    ) -> Result<EscapeState, SceneError> {
        let after_s = followed_s + tick.dt;
        self.known.trajectory.q_at(after_s, &mut self.next.q);
        for (j, v) in next.iter_mut().enumerate() {
            *v = (self.next.q[j] - tick.start.q[j]) / tick.dt;
            self.next.qd[j] = *v;
        }
        self.known.followed_s = Some(after_s);
        let horizon_s = self.settings.horizon_s;
        let motion =
            EscapeMotion { trajectory: &self.known.trajectory, elapsed_s: after_s, begins_s: tick.dt, horizon_s };
        let remains = self.check.meets_moving(&motion, tick.obstacles, clearance.moving_m, |_| true)?;
        if let Some(hit) = remains.hit
            && self.find(tick, &stop_hit.unwrap_or(hit), clearance, constraint)?
        {
            self.known.followed_s = Some(0.0);
        }
        Ok(EscapeState::Escaping)
    }

    /// Searches an escape from the robot's state after the command, to the known target or to a new one; returns
    /// whether one is known.
    fn find(
        &mut self,
        tick: &EscapeTick<'_>,
        hit: &PredictedHit,
        clearance: EscapeClearance,
        constraint: &mut Option<&mut dyn PathConstraint>,
    ) -> Result<bool, SceneError> {
        self.trial.best = None;
        let mut attempts = self.settings.per_tick;
        if self.known.is_proven {
            self.trial.target.copy_from_slice(&self.known.target);
            self.examine_trial(tick, clearance, constraint)?;
            // One other target, in case it is better.
            if self.trial.best.is_some() {
                self.known.examined += 1;
                let may_improve = self.trial.best.is_some_and(|best| best.may_improve());
                attempts = usize::from(may_improve && self.known.examined.is_multiple_of(IMPROVE_TICKS));
            }
        }
        if attempts > 0 {
            self.update_point(tick, hit);
        }
        for _ in 0..attempts {
            if self.check.is_overdue() {
                break;
            }
            self.set_trial_target(tick, hit);
            self.examine_trial(tick, clearance, constraint)?;
            // A target that was not examined completely is examined once more in a later tick, with more of that tick's
            // work.
            self.trial.is_repeated = self.check.is_overdue() && !self.trial.is_repeated;
            self.trial.index -= usize::from(self.trial.is_repeated);
        }
        Ok(self.trial.best.is_some())
    }

    /// Examines the trial target; the best one becomes the known escape.
    fn examine_trial(
        &mut self,
        tick: &EscapeTick<'_>,
        clearance: EscapeClearance,
        constraint: &mut Option<&mut dyn PathConstraint>,
    ) -> Result<(), SceneError> {
        let start = EscapeStart { q: &self.next.q, qd: &self.next.qd, ..tick.start };
        self.trial.trajectory.set_target(&self.trial.target, &start);
        let horizon_s = self.settings.horizon_s;
        let motion = EscapeMotion { trajectory: &self.trial.trajectory, elapsed_s: 0.0, begins_s: tick.dt, horizon_s };
        let moving = self.check.meets_moving(&motion, tick.obstacles, clearance.moving_m, |_| true)?;
        let escape = EscapeCandidate { gap_m: moving.gap_m, duration_s: self.trial.trajectory.duration_s };
        let is_worse = self.trial.best.is_some_and(|best| !escape.is_better_than(&best));
        if !moving.is_free()
            || is_worse
            || !self.check.keeps_clear_of_fixed(&motion, tick.obstacles, clearance.fixed_m)?
            || constraint.as_deref_mut().is_some_and(|c| !self.check.keeps_constraint(&motion, c))
        {
            return Ok(());
        }
        self.trial.best = Some(escape);
        (self.known.is_proven, self.known.is_fresh) = (true, true);
        std::mem::swap(&mut self.known.trajectory, &mut self.trial.trajectory);
        self.known.target.copy_from_slice(&self.trial.target);
        Ok(())
    }

    /// Updates the velocity of the hit point, per joint at its top speed.
    fn update_point(&mut self, tick: &EscapeTick<'_>, hit: &PredictedHit) {
        let robot = &self.scene.robots()[self.robot.0];
        let in_root = robot.base_in_world.inverse_transform_point(hit.point);
        let speeds = tick.start.limits.iter().map(|limit| limit.velocity);
        self.point.update(&robot.robot.chain, |q| self.stop.q_at(hit.time_s, q), (hit.link, in_root), speeds);
    }

    fn set_trial_target(&mut self, tick: &EscapeTick<'_>, hit: &PredictedHit) {
        let base = self.scene.robots()[self.robot.0].base_in_world;
        let directions = EscapeDirections {
            point: &self.point.velocity,
            at: base.inverse_transform_point(hit.point),
            along: base.inverse_transform_vector(hit.velocity).try_normalize().unwrap_or(Vec3::X),
        };
        self.stop.q_at(self.stop.duration_s, &mut self.rest_q);
        let homes = [tick.reference_q, &self.home_q];
        target(self.trial.index, &self.rest_q, &tick.start, &directions, homes, &mut self.trial.target);
        self.trial.index += 1;
    }
}
