//! Time parametrization of paths in the exact scene: a corner is blended if the result is proven free.

use elbowroom_kinematics::{JointLimits, TrajectoryRow};
use elbowroom_scene::SceneState;

use super::error::RrtConnectError;
use super::motion_validator::MotionValidator as _;
use super::planner::RrtConnect;
use super::settings::RrtConnectSettings;
use crate::joint_path::JointPath;
use crate::time_parametrization::{BlendedTrajectory, PathElement, PathSegments};
use crate::timed_path::TimedPath;

/// Number of times that the blend distance of a corner is halved before the trajectory stops at the corner.
const MAX_HALVINGS: i32 = 5;
/// Fraction of a period by which the element of a sample is looked up beside the sample if it lies on the border of two
/// elements: a stop is the end of one segment and the beginning of the next.
const INSET_PERIODS: f64 = 1e-6;

impl RrtConnect<'_> {
    /// Computes the time parametrization of a path that was planned from `start`, within limits.
    ///
    /// The motion is straight along the path's segments, which are proven. A corner is blended if that is proven free;
    /// otherwise the motion stops there. The proof covers the polyline through the positions at every `period` (s),
    /// which [`BlendedTrajectory::samples`] returns and which a controller with linear interpolation follows. The trajectory
    /// rests only at multiples of the period.
    ///
    /// ```
    /// use elbowroom_kinematics::JointLimits;
    /// use elbowroom_planner::{RrtConnect, RrtConnectSettings};
    /// use elbowroom_robot::RobotId;
    /// use elbowroom_scene::{SceneState, example};
    /// let scene = example::two_arms();
    /// let mut state = SceneState::new(&scene);
    /// state.set_q(&scene, RobotId(0), &[-0.9, 1.3, 0.6])?;
    /// let (mut planner, settings) = (RrtConnect::new(&scene, RobotId(0))?, RrtConnectSettings::default());
    /// let path = planner.plan(&state, &[0.9, 1.3, 0.6], &settings)?;
    /// let limits = vec![JointLimits::new(2.0, 8.0, 80.0); 3];
    /// let trajectory = planner.time_parametrize(&state, &path, &limits, 0.004, &settings)?;
    /// let samples = trajectory.samples(0.004)?;
    /// assert_eq!(samples.last(), Some(&[0.9, 1.3, 0.6][..]));
    /// assert!(trajectory.seconds() > path.length_rad / 2.0_f64.hypot(2.0).hypot(2.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// The limits are not one finite number above 0 per joint, the period is invalid, or the path belongs to another
    /// robot.
    pub fn time_parametrize(
        &mut self,
        start: &SceneState,
        path: &JointPath,
        limits: &[JointLimits],
        period: f64,
        settings: &RrtConnectSettings,
    ) -> Result<BlendedTrajectory, RrtConnectError> {
        self.prepare(start, path.waypoints.last().map_or(&[], |q| q), settings)?;
        let segments = PathSegments::new(&path.waypoints, limits)?;
        let largest = |n: usize| if n > 0 { segments.max_blend_distance(n) } else { 0.0 };
        let mut blend_distances: Vec<f64> = (0..segments.count()).map(largest).collect();
        let least: Vec<f64> = blend_distances.iter().map(|distance| distance * 0.5_f64.powi(MAX_HALVINGS)).collect();
        loop {
            let trajectory = BlendedTrajectory::new(segments.clone(), &blend_distances).aligned_to_ticks(period)?;
            let unproven = self.unproven_corners(&trajectory, period)?;
            if unproven.is_empty() {
                return Ok(trajectory);
            }
            let before = blend_distances.clone();
            for n in unproven {
                blend_distances[n] = if blend_distances[n] > least[n] { 0.5 * blend_distances[n] } else { 0.0 };
            }
            if blend_distances == before {
                // No smaller blend is left. With stops at all corners, samples go from waypoint to waypoint.
                blend_distances.fill(0.0);
                return Ok(BlendedTrajectory::new(segments, &blend_distances).aligned_to_ticks(period)?);
            }
        }
    }

    /// Like [`time_parametrize`](Self::time_parametrize), with the path and its motion at every `period` (s).
    pub(crate) fn timed(
        &mut self,
        start: &SceneState,
        path: JointPath,
        limits: &[JointLimits],
        period: f64,
        settings: &RrtConnectSettings,
    ) -> Result<TimedPath, RrtConnectError> {
        let motion = self.time_parametrize(start, &path, limits, period, settings)?;
        Ok(TimedPath { path, trajectory: motion.samples(period)?, stops: motion.stops() })
    }

    /// The corners at which the polyline through the samples is not proven free.
    fn unproven_corners(&mut self, trajectory: &BlendedTrajectory, period: f64) -> Result<Vec<usize>, RrtConnectError> {
        use PathElement::{Corner, Segment};
        let samples = trajectory.samples(period)?;
        let mut unproven = Vec::new();
        for pair in samples.rows().windows(2) {
            let [TrajectoryRow { t_s: t, q: a }, TrajectoryRow { t_s: next, q: b }] = pair else { continue };
            let inset = INSET_PERIODS * period;
            let (first, last) = match (trajectory.element_at(t + inset), trajectory.element_at(next - inset)) {
                // Both samples on one segment, which is proven.
                (Some(Segment(m)), Some(Segment(n))) if m == n => continue,
                (Some(Segment(m)), Some(Segment(n) | Corner(n))) => (m + 1, n),
                (Some(Corner(m)), Some(Segment(n) | Corner(n))) => (m, n),
                _ => continue,
            };
            let known = (first..=last).all(|n| unproven.contains(&n));
            if !known && !self.validator.proves_motion(a, b) {
                unproven.extend(first..=last);
            }
        }
        unproven.sort_unstable();
        unproven.dedup();
        Ok(unproven)
    }
}
