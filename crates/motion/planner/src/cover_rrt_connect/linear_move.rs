//! Moves of the tip along a straight line.

use std::time::Instant;

use elbowroom_kinematics::inverse::{IkOptions, IkSolver};
use elbowroom_kinematics::{Chain, ChainState, LinkId};
use elbowroom_scene::SceneState;
use elbowroom_spatial::Pose;

use super::planner::CoverRrtConnect;
use crate::grid_path::PathEnd;
use crate::interpolation::{length, lerp, path_length};
use crate::joint_path::JointPath;
use crate::rrt_connect::{LinearMoveEnd, MotionValidator, RrtConnectError, RrtConnectSettings};

/// Largest first step along the line: translation of the tip, m, and rotation, rad.
const STEP: f64 = 0.05;
/// Fraction of the line below which a step is not divided further.
const SHORTEST_STEP: f64 = 1e-6;
/// Motion of the joints, rad (and m), above which a step has changed the posture.
const LONGEST_JOINT_STEP: f64 = 0.5;

/// A straight line of a tip: its position moves uniformly along the line, its orientation turns uniformly by the
/// shortest rotation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearMove {
    /// The link that the tip belongs to.
    pub link: LinkId,
    /// Pose of the tip in the frame of the link.
    pub tip_in_link: Pose,
    /// Pose of the tip at the end of the line.
    pub target_in_world: Pose,
    /// Largest distance of the tip from the line while the joints move straight between waypoints, m.
    pub tolerance_m: f64,
    /// Largest rotation of the tip from the orientation on the line, rad.
    pub tolerance_rad: f64,
}

impl CoverRrtConnect<'_> {
    /// Computes the joint path of a straight line of the tip from the robot's configuration in `start`, in one posture,
    /// proven free. The deviation from the line is measured at the quarters of each segment.
    ///
    /// # Errors
    /// The errors of [`plan`](Self::plan) for the start; [`RrtConnectError::LinearMove`] with the fraction of the line
    /// that can be followed.
    pub fn plan_linear(
        &mut self,
        start: &SceneState,
        line: &LinearMove,
        settings: &RrtConnectSettings,
    ) -> Result<JointPath, RrtConnectError> {
        let begin = Instant::now();
        let robot = self.exact.robot();
        let from = self.validator().ends(start, start.q(robot), settings)?[0].clone();
        self.exact.free_margin_m(PathEnd::Start, &from)?;
        let placed = self.exact.placed_robot();
        let chain = self.exact.validator.bounds.narrowed_chain(&placed.robot.chain);
        let mut follower = LineFollower::new(&chain, placed.base_in_world, line, &from);
        let mut waypoints = vec![from];
        while follower.share < 1.0 {
            if self.exact.validator.deadline.is_interrupted() {
                return Err(self.covers.not_found(begin.elapsed(), waypoints.len()));
            }
            let before = &waypoints[waypoints.len() - 1];
            let percent = 100.0 * follower.share;
            let ended = |end: LinearMoveEnd| RrtConnectError::LinearMove { percent, end };
            let bounds = &self.exact.validator.bounds;
            let next = follower.next(before).filter(|next| bounds.contains(next));
            let next = next.ok_or_else(|| ended(LinearMoveEnd::Unreachable))?;
            if !self.is_proven(before, &next) {
                return Err(ended(LinearMoveEnd::NotFree));
            }
            waypoints.push(next);
        }
        let length_rad = path_length(&waypoints);
        Ok(JointPath {
            waypoints,
            length_rad,
            raw_length_rad: length_rad,
            planning_time: begin.elapsed(),
            simplification_time: std::time::Duration::ZERO,
            states_checked: self.covers.states_checked(),
        })
    }

    fn is_proven(&mut self, from: &[f64], to: &[f64]) -> bool {
        let sweep = self.exact.validator.sweep;
        self.validator().motion_is_free(from, to)
            || self.covers.is_free_exactly(&mut self.exact.validator, from, to, &sweep)
    }
}

/// Follows a line with the joints.
struct LineFollower<'c> {
    chain: &'c Chain,
    line: &'c LinearMove,
    solver: IkSolver,
    state: ChainState,
    from_in_root: Pose,
    to_in_root: Pose,
    /// Followed fraction of the line.
    share: f64,
    /// Largest step, as a fraction of the line.
    step: f64,
}

impl<'c> LineFollower<'c> {
    fn new(chain: &'c Chain, base_in_world: Pose, line: &'c LinearMove, q: &[f64]) -> Self {
        let mut follower = Self {
            chain,
            line,
            solver: IkSolver::new(chain, line.link, line.tip_in_link, IkOptions::default()),
            state: ChainState::new(chain),
            from_in_root: Pose::IDENTITY,
            to_in_root: base_in_world.inverse_mul(&line.target_in_world),
            share: 0.0,
            step: 1.0,
        };
        follower.from_in_root = follower.tip_in_root(q);
        let way = follower.from_in_root.inverse_mul(&follower.to_in_root);
        let size = way.translation.length().max(way.rotation.angle());
        follower.step = 1.0 / (size / STEP).ceil().max(1.0);
        follower
    }

    fn tip_in_root(&mut self, q: &[f64]) -> Pose {
        self.state.q.copy_from_slice(q);
        self.chain.forward(&mut self.state);
        self.state.link_in_root(self.line.link) * self.line.tip_in_link
    }

    fn on_line(&self, share: f64) -> Pose {
        self.from_in_root.interpolate(&self.to_in_root, share)
    }

    /// The next configuration, as far along the line as the tolerance permits.
    fn next(&mut self, from: &[f64]) -> Option<Vec<f64>> {
        let mut step = self.step.min(1.0 - self.share);
        while step > SHORTEST_STEP {
            // Rounding must not leave a last step of length 0.
            let to_share = if self.share + step > 1.0 - SHORTEST_STEP { 1.0 } else { self.share + step };
            let mut to = from.to_vec();
            if self.solver.refine(&self.on_line(to_share), &mut to)
                && length(from, &to) <= LONGEST_JOINT_STEP
                && self.stays_near(from, &to, to_share)
            {
                self.share = to_share;
                return Some(to);
            }
            step *= 0.5;
        }
        None
    }

    /// Whether the tip is within the tolerance of the line at the quarters of a segment.
    fn stays_near(&mut self, from: &[f64], to: &[f64], to_share: f64) -> bool {
        let mut q = from.to_vec();
        [0.25, 0.5, 0.75].iter().all(|&part| {
            lerp(from, to, part, &mut q);
            let wanted = self.on_line(self.share + (to_share - self.share) * part);
            let off = wanted.inverse_mul(&self.tip_in_root(&q));
            off.translation.length() <= self.line.tolerance_m && off.rotation.angle() <= self.line.tolerance_rad
        })
    }
}
