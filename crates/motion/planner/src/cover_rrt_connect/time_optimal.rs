//! Time-optimal motion along a planned path: corners are blended if the covers prove the blend.

use elbowroom_kinematics::{JointLimits, JointTrajectory};
use elbowroom_scene::SceneState;

use super::cover_validator::CoverValidator;
use super::planner::CoverRrtConnect;
use crate::joint_path::JointPath;
use crate::rrt_connect::{MotionValidator, RrtConnectError, RrtConnectSettings};
use crate::time_parametrization::{BlendedPath, CornerBlend};
use crate::timed_path::TimedPath;

/// Number of chords by which a blend is tested before it is timed.
const BLEND_PIECES: usize = 4;

impl CoverRrtConnect<'_> {
    /// Computes the fastest motion along a path within limits of speed, acceleration and jerk, with a row every
    /// `period` (s).
    ///
    /// The path must have been planned from `start`: its segments are proven. The polyline through the rows is proven
    /// free, too. Corners are rounded, so that the motion does not rest at them, unless the path turns back or the
    /// rounded corner cannot be proven.
    ///
    /// # Errors
    /// The limits are not one finite number above 0 per joint, the period is invalid, or the path belongs to another
    /// robot.
    pub fn time_parametrize(
        &mut self,
        start: &SceneState,
        path: JointPath,
        limits: &[JointLimits],
        period: f64,
        settings: &RrtConnectSettings,
    ) -> Result<TimedPath, RrtConnectError> {
        let goal = path.waypoints.last().map_or(&[][..], |q| q);
        self.exact.begin(start, goal, settings)?;
        let covers = &mut self.covers;
        let blended = BlendedPath::new(&path.waypoints, |blend| is_free(covers, blend))?;
        let motion = blended.time_optimal(limits)?.aligned_to_ticks(period)?;
        let trajectory = motion.samples(period)?;
        if self.proves(&trajectory) {
            return Ok(TimedPath { path, trajectory, stops: motion.stops() });
        }
        self.exact.timed(start, path, limits, period, settings)
    }

    /// Whether the polyline through the rows is proven free.
    fn proves(&mut self, trajectory: &JointTrajectory) -> bool {
        let sweep = self.exact.validator.sweep;
        trajectory.rows().windows(2).all(|pair| {
            let (from, to) = (&pair[0].q, &pair[1].q);
            let is_free = self.covers.motion_is_free(from, to) && self.exact.validator.constraint_allows(from, to);
            is_free || self.covers.is_free_exactly(&mut self.exact.validator, from, to, &sweep)
        })
    }
}

fn is_free(covers: &mut CoverValidator, blend: &CornerBlend) -> bool {
    let (points, _) = blend.polyline(BLEND_PIECES);
    points.windows(2).all(|pair| covers.motion_is_free(&pair[0], &pair[1]))
}
