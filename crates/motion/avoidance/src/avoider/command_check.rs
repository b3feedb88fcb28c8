//! Checks of the next command: a stop after it, and an escape, must be left.

use elbowroom_planner::PathConstraint;
use elbowroom_scene::SweepOptions;

use super::{Avoider, Correction, Workspace};
use crate::escape_check::EscapeClearance;
use crate::escape_search::EscapeTick;
use crate::escape_trajectory::EscapeStart;
use crate::joint_limits::{brake, stop_s};
use crate::objective::Objective;
use crate::sweep_check::VelocitySegment;
use crate::{DynamicObstacles, EscapeState, ObstacleKind, ProximityPair, Reference};

impl Avoider<'_> {
    /// Checks the next command and replaces it by braking if that is safer.
    pub(super) fn check(
        &mut self,
        dt: f64,
        reference: &Reference<'_>,
        obstacles: &DynamicObstacles<'_>,
        objective: Objective,
        correction: &mut Correction,
    ) {
        correction.can_stop = self.can_stop(dt, obstacles, objective == Objective::Detour);
        if correction.can_stop {
            correction.is_braked = self.brake_before_hit(dt, obstacles);
            return;
        }
        self.machine.abandon_detour();
        if objective == Objective::Path {
            // The path is known to be free: the robot slows down on it.
            self.follow_reference(dt, reference);
            correction.is_reference = true;
        } else {
            self.brake(dt);
        }
        correction.is_braked = true;
    }

    /// Replaces the next command by the command of an escape if no escape would be left after it.
    pub(super) fn keep_escape(
        &mut self,
        dt: f64,
        reference: &Reference<'_>,
        obstacles: &DynamicObstacles<'_>,
        allowed: f64,
        constraint: Option<&mut dyn PathConstraint>,
        correction: &mut Correction,
    ) -> EscapeState {
        let nearest = |counts: fn(&ObstacleKind) -> bool| {
            self.query.pairs.iter().find(|p| counts(&p.obstacle)).map_or(f64::INFINITY, |p| p.distance_m)
        };
        let nearest =
            EscapeClearance { moving_m: nearest(ObstacleKind::is_dynamic), fixed_m: nearest(|o| !o.may_move()) };
        let start = EscapeStart {
            q: &self.command.q,
            qd: &self.command.qd,
            limits: &self.limits,
            speed_share: allowed,
            reversals: &self.reversals,
        };
        let can_stop = correction.can_stop;
        let tick = EscapeTick { dt, start, obstacles, reference_q: reference.q, can_stop, nearest };
        let state = self.escapes.guard(&tick, constraint, &mut self.workspace.next);
        if state == EscapeState::Escaping {
            self.machine.abandon_detour();
            self.command.intent.copy_from_slice(&self.workspace.next);
            correction.is_reference = false;
            correction.progress = 1.0;
            correction.reaction.is_active = true;
            correction.reaction.size = 1.0;
        }
        state
    }

    /// Whether the command and a stop after it hit no fixed or known obstacle. While every command satisfies this, a
    /// collision-free stop exists: the stop of the previous command. A detour was checked against all fixed obstacles;
    /// while the robot follows it, the obstacles that may have moved since then count instead.
    fn can_stop(&mut self, dt: f64, obstacles: &DynamicObstacles<'_>, is_detour: bool) -> bool {
        let duration_s = 2.0 * dt + 0.5 * stop_s(&self.limits, &self.workspace.next);
        // Pairs in intended contact, such as a part being placed, are ignored: only their distance must not decrease.
        let is_apart = |p: &ProximityPair| p.distance_m > SweepOptions::default().tolerance_m;
        let has_left_detour = !self.machine.has_detour();
        let counts = |p: &ProximityPair| match p.obstacle {
            ObstacleKind::OwnLink(_) | ObstacleKind::Fixed => !is_detour || has_left_detour,
            ObstacleKind::KnownMoving { .. } => true,
            ObstacleKind::Dynamic { .. } => is_detour,
        };
        let segment =
            VelocitySegment { q: &self.command.q, qd: &self.workspace.next, limits: &self.limits, duration_s };
        let filter = |p: &ProximityPair| counts(p) && is_apart(p);
        self.sweep.first_hit(&mut self.query, &segment, obstacles, filter).is_none()
    }

    /// Brakes if the command hits a dynamic obstacle, and braking hits later or the hit is unproven. Returns whether.
    fn brake_before_hit(&mut self, dt: f64, obstacles: &DynamicObstacles<'_>) -> bool {
        let Self { sweep, query, limits, command, workspace, .. } = self;
        let Workspace { bounds, next, braked, .. } = workspace;
        let mut first_hit = |qd: &[f64]| {
            let segment = VelocitySegment { q: &command.q, qd, limits, duration_s: dt };
            sweep.first_hit(query, &segment, obstacles, |p| p.obstacle.is_dynamic())
        };
        let Some(hit) = first_hit(next) else { return false };
        brake(limits, &bounds.stoppable, &command.qd, dt, braked);
        let is_better = !hit.is_proven || first_hit(braked).map_or(f64::INFINITY, |b| b.time) > hit.time;
        if is_better {
            next.copy_from_slice(braked);
        }
        is_better
    }
}
