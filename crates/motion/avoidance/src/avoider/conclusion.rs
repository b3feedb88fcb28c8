//! The end of a tick: the state machine and the output.

use elbowroom_kinematics::LinkId;
use elbowroom_spatial::Vec3;

use super::{Avoider, MIN_PROGRESS};
use crate::detour::SAME_CONFIGURATION_S;
use crate::joint_limits::distance_s;
use crate::path_rate::{PathState, approach_rate, is_path_held, path_rate};
use crate::proximity_query::ProximityQuery;
use crate::state_machine::TickSummary;
use crate::{AvoiderOutput, EscapeState, ObstacleKind, PathKind, ProximityPair, Reaction, Reference};

/// Path deviation up to which the robot counts as arrived, in seconds of joint motion.
const ARRIVED_S: f64 = 2e-3;
/// Size below which a correction does not count.
const MIN_CORRECTION: f64 = 0.02;
/// Speed below which an obstacle is stationary, m/s.
const STATIONARY_OBSTACLE_M_S: f64 = 0.01;

impl Avoider<'_> {
    /// The point of the robot's surface that a reaction of the last tick steers: the link, the point in its frame, m, and its
    /// distance from the obstacle, m.
    pub fn collision_point(&self, reaction: &Reaction) -> Option<(LinkId, Vec3, f64)> {
        let pair = self.query.pairs.get(reaction.governing?)?;
        let link_in_root = self.query.chains[self.query.robot.0].link_in_root(pair.link);
        Some((pair.link, link_in_root.inverse_transform_point(pair.on_link), pair.distance_m))
    }

    /// Ends the tick: updates the state machine and completes the output.
    pub(super) fn conclude(
        &mut self,
        dt: f64,
        reference: &Reference<'_>,
        allowed: f64,
        progress: f64,
        mut output: AvoiderOutput,
    ) -> AvoiderOutput {
        output.path_deviation_s = distance_s(reference.q, &self.command.q, &self.limits);
        let is_at_reference = output.path_deviation_s <= SAME_CONFIGURATION_S;
        let is_following = is_at_reference && !self.machine.has_detour();
        let is_stationary = self.is_stationary();
        let requires_motion =
            output.path_deviation_s > ARRIVED_S || (is_following && reference.qd.iter().any(|v| *v != 0.0));
        let tick = TickSummary {
            dt,
            is_at_reference,
            is_corrected: self.is_corrected(&output, reference.path),
            is_stalled: requires_motion
                && allowed > 0.0
                && (progress < MIN_PROGRESS || (is_following && is_stationary)),
            is_stationary,
            is_halted: allowed == 0.0,
        };
        self.machine.end_tick(&tick);
        let pairs = &self.query.pairs;
        output.nearest_m =
            pairs.iter().find(|p| p.obstacle.is_dynamic()).map_or(f64::INFINITY, |nearest| nearest.distance_m);
        output.governed_by = output.reaction.governing.and_then(|g| pairs.get(g)).and_then(|p| match p.obstacle {
            ObstacleKind::Dynamic { key, .. } => Some(key),
            _ => None,
        });
        let is_idle = self.machine.state().idle_s() > 0.0;
        output.requests_detour = !self.has_detour() && is_stationary && (is_idle || self.is_stalled());
        output.rate = if self.has_detour() || (output.braked && is_following) {
            0.0
        } else {
            self.path_rate(reference, output.path_deviation_s)
        };
        output.state = self.machine.reported(&tick, output.reaction.is_active);
        output
    }

    /// Whether the tick evaded an obstacle that will move away. If the path is held, waiting beside an obstacle at rest
    /// would never end: a detour leads past it.
    fn is_corrected(&self, output: &AvoiderOutput, path: PathKind) -> bool {
        let is_held = is_path_held(path, output.path_deviation_s, self.settings.max_deviation_s);
        let is_at_rest = self.is_by_obstacle_at_rest(&output.reaction);
        let will_move_on = !(is_at_rest && is_held) || output.escape == EscapeState::Escaping;
        output.reaction.size > MIN_CORRECTION && will_move_on
    }

    /// Whether the obstacle that governs a reaction is at rest.
    pub(super) fn is_by_obstacle_at_rest(&self, reaction: &Reaction) -> bool {
        let governing = reaction.governing.and_then(|g| self.query.pairs.get(g));
        governing.is_some_and(|p| p.obstacle_velocity().length() <= STATIONARY_OBSTACLE_M_S)
    }

    /// Whether the robot has made no progress for the stall timeout and no obstacle moves.
    pub(super) fn is_stalled(&self) -> bool {
        let moves = |p: &ProximityPair| p.obstacle_velocity().length() > STATIONARY_OBSTACLE_M_S;
        self.machine.is_stalled() && !self.query.pairs.iter().any(moves)
    }

    /// Rate at which the path may advance.
    fn path_rate(&mut self, reference: &Reference<'_>, deviation_s: f64) -> f64 {
        let max_deviation_s = self.settings.max_deviation_s;
        let state = PathState { q: &self.command.q, limits: &self.limits, deviation_s, max_deviation_s };
        let ProximityQuery { scene, robot, chains, pairs, .. } = &self.query;
        let (chain, chain_state) = (&scene.robots()[robot.0].robot.chain, &chains[robot.0]);
        let columns = &mut self.workspace.columns;
        let settings = &self.settings.reactive;
        path_rate(reference, &state, || {
            approach_rate(chain, chain_state, pairs.iter(), settings, reference.qd, columns)
        })
    }
}
