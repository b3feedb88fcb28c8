//! Time-optimal motion along a planned path: corners are blended if the covers prove the blend.

use elbowroom_kinematics::JointLimits;
use elbowroom_scene::SceneState;

use super::cover_validator::CoverValidator;
use super::planner::CoverRrtConnect;
use crate::rrt_connect::{MotionValidator, PlannedPath, RrtConnectError, RrtConnectSettings};
use crate::time_parametrization::{BlendedPath, CornerBlend, Trajectory};

/// Number of chords by which a blend is tested before it is timed.
const BLEND_PIECES: usize = 4;

/// A motion in time, at rest at both ends.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedMotion {
    /// Duration, s.
    pub duration_s: f64,
    /// Number of corners at which the motion rests.
    pub stops: usize,
    /// Time (s) and values (rad, m for prismatic joints), linear in between.
    pub rows: Vec<(f64, Vec<f64>)>,
}

impl TimedMotion {
    /// Samples a trajectory, with a row every `period` (s).
    ///
    /// # Errors
    /// The period is not a finite number above 0.
    pub fn of(trajectory: &Trajectory, period: f64) -> Result<Self, RrtConnectError> {
        let rows = trajectory.samples(period)?;
        Ok(Self { duration_s: trajectory.seconds(), stops: trajectory.stops(), rows })
    }
}

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
        path: &PlannedPath,
        limits: &[JointLimits],
        period: f64,
        settings: &RrtConnectSettings,
    ) -> Result<TimedMotion, RrtConnectError> {
        let goal = path.waypoints.last().map_or(&[][..], |q| q);
        self.exact.begin(start, goal, settings)?;
        let covers = &mut self.covers;
        let blended = BlendedPath::new(&path.waypoints, |blend| is_free(covers, blend))?;
        let trajectory = blended.time_optimal(limits)?.aligned_to_ticks(period)?;
        let rows = trajectory.samples(period)?;
        if self.are_proven(&rows) {
            return Ok(TimedMotion { duration_s: trajectory.seconds(), stops: trajectory.stops(), rows });
        }
        TimedMotion::of(&self.exact.time_parametrize(start, path, limits, period, settings)?, period)
    }

    /// Whether the polyline through the rows is proven free.
    fn are_proven(&mut self, rows: &[(f64, Vec<f64>)]) -> bool {
        let sweep = self.exact.validator.sweep;
        rows.windows(2).all(|pair| {
            let (from, to) = (&pair[0].1, &pair[1].1);
            let is_free = self.covers.motion_is_free(from, to) && self.exact.validator.constraint_allows(from, to);
            is_free || self.covers.is_free_exactly(&mut self.exact.validator, from, to, &sweep)
        })
    }
}

fn is_free(covers: &mut CoverValidator, blend: &CornerBlend) -> bool {
    let (points, _) = blend.polyline(BLEND_PIECES);
    points.windows(2).all(|pair| covers.motion_is_free(&pair[0], &pair[1]))
}
