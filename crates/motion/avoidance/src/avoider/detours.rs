//! Detours: planned around the obstacles at their present poses, and followed by the control loop.

use elbowroom_planner::{PathConstraint, RrtConnect, RrtConnectSettings};

use super::{Avoider, PlannedDetour};
use crate::AvoidanceError;
use crate::detour::{Detour, SAME_CONFIGURATION_S};
use crate::joint_limits::distance_s;

/// Largest distance from the start of a detour at which a stationary robot starts it, in seconds of joint motion.
const MAX_DETOUR_DRIFT_S: f64 = 1e-3;

impl Avoider<'_> {
    /// Plans a detour from the present configuration to `goal` around all obstacles at their present poses, checks that
    /// it is free, and follows it from the next tick until an obstacle has to be evaded. The detour keeps the clearance,
    /// except straight at a tight end ([`RrtConnect::plan_from_tight_ends`]). Planning takes time: call it outside the loop.
    ///
    /// # Errors
    /// The robot moves, or the errors of [`RrtConnect::plan_from_tight_ends`].
    pub fn plan_to(&mut self, goal: &[f64], options: &RrtConnectSettings) -> Result<(), AvoidanceError> {
        let detour = self.plan_detour(goal, options, None)?;
        self.follow_detour(detour)
    }

    /// Plans like [`plan_to`](Self::plan_to), with a constraint on the path ([`RrtConnect::with_constraint`]), such as
    /// regions in which a monitor stops the robot. [`follow_detour`](Self::follow_detour) follows the detour later.
    ///
    /// # Errors
    /// The robot moves, or the errors of [`RrtConnect::plan_from_tight_ends`].
    pub fn plan_detour(
        &mut self,
        goal: &[f64],
        options: &RrtConnectSettings,
        constraint: Option<&mut dyn PathConstraint>,
    ) -> Result<PlannedDetour, AvoidanceError> {
        if !self.is_stationary() {
            return Err(AvoidanceError::NotStationary);
        }
        let limits = self.limits.iter().map(|l| (l.lower, l.upper));
        let mut planner = RrtConnect::new(self.query.scene, self.query.robot)?.with_limits(limits);
        if let Some(constraint) = constraint {
            planner = planner.with_constraint(constraint);
        }
        self.query.state.set_q(self.query.scene, self.query.robot, &self.command.q)?;
        let route = planner.plan_from_tight_ends(&self.query.state, goal, options)?;
        Ok(PlannedDetour { start_q: self.command.q.clone(), waypoints: route.waypoints })
    }

    /// Follows a detour from the next tick until an obstacle has to be evaded. A robot that has come to rest slightly
    /// beyond the start of the detour returns to the start first.
    ///
    /// # Errors
    /// The robot moves, or has moved away since the detour was planned.
    pub fn follow_detour(&mut self, detour: PlannedDetour) -> Result<(), AvoidanceError> {
        let drift_s = distance_s(&detour.start_q, &self.command.q, &self.limits);
        if drift_s > MAX_DETOUR_DRIFT_S || !self.is_stationary() {
            return Err(AvoidanceError::NotStationary);
        }
        self.machine.start_detour(Detour::new(detour.waypoints, drift_s <= SAME_CONFIGURATION_S));
        Ok(())
    }

    /// Reports that a detour is being planned. Until the detour is known, a robot off its path rests where the detour
    /// starts, unless it has to evade a moving obstacle. Call this method in each tick of the planning.
    pub fn await_detour(&mut self) {
        self.machine.await_detour();
    }
}
