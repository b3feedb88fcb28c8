//! Time-optimal trajectories: joint values as a function of time along a blended path.

use super::super::blended_trajectory::{periods, sampled, validate_period};
use super::super::limits::{TimeParametrizationError, validate};
use super::blended_path::BlendedPath;
use super::section_motion::SectionMotion;
use elbowroom_kinematics::{JointLimits, JointTrajectory, TrajectoryPoint};

/// A blended path with a time-optimal parametrization, at rest at both ends.
#[derive(Debug, Clone)]
pub struct TimeOptimalTrajectory {
    path: BlendedPath,
    motions: Vec<SectionMotion>,
    /// Times at which the sections begin, and the duration, s.
    times: Vec<f64>,
}

impl BlendedPath {
    /// Computes the fastest motion along the path within limits of velocity, acceleration and jerk. All three limits
    /// are kept at every instant; acceleration is continuous. For prismatic joints, read m instead of rad in the
    /// limits.
    ///
    /// ```
    /// use elbowroom_kinematics::JointLimits;
    /// use elbowroom_planner::BlendedPath;
    /// let waypoints = [vec![0.0, 0.0], vec![1.0, 0.0], vec![1.0, 1.0]];
    /// let path = BlendedPath::new(&waypoints, |blend| blend.distance() <= 0.3)?;
    /// let limits = vec![JointLimits::new(1.0, 4.0, 40.0); 2];
    /// let trajectory = path.time_optimal(&limits)?;
    /// assert_eq!(trajectory.at(trajectory.seconds()).q, [1.0, 1.0]);
    /// // With a rest at the corner it takes 2.7 s.
    /// assert!(trajectory.seconds() < 2.5 && path.stops() == 0);
    /// # Ok::<(), elbowroom_planner::TimeParametrizationError>(())
    /// ```
    ///
    /// # Errors
    /// The limits are not one finite number above 0 per joint, or so small that no duration is finite.
    pub fn time_optimal(&self, limits: &[JointLimits]) -> Result<TimeOptimalTrajectory, TimeParametrizationError> {
        validate(limits, self.joints())?;
        let motions = self.sections.iter().map(|section| SectionMotion::with_jerk_limit(section, limits));
        Ok(TimeOptimalTrajectory::new(self.clone(), motions.collect::<Result<_, _>>()?))
    }

    /// Computes the fastest motion within limits of velocity and acceleration (TOPP-RA). Jerk is not limited:
    /// acceleration jumps.
    ///
    /// # Errors
    /// The errors of [`Self::time_optimal`].
    pub fn time_optimal_without_jerk_limit(
        &self,
        limits: &[JointLimits],
    ) -> Result<TimeOptimalTrajectory, TimeParametrizationError> {
        validate(limits, self.joints())?;
        let motions = self.sections.iter().map(|section| SectionMotion::without_jerk_limit(section, limits));
        Ok(TimeOptimalTrajectory::new(self.clone(), motions.collect::<Result<_, _>>()?))
    }
}

impl TimeOptimalTrajectory {
    fn new(path: BlendedPath, motions: Vec<SectionMotion>) -> Self {
        let mut times = vec![0.0];
        times.extend(motions.iter().scan(0.0, |time, motion| {
            *time += motion.seconds();
            Some(*time)
        }));
        Self { path, motions, times }
    }

    /// Duration, s.
    pub fn seconds(&self) -> f64 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// Number of corners at which the motion rests.
    pub fn stops(&self) -> usize {
        self.path.stops()
    }

    /// Number of grid intervals on which the motion was computed.
    pub fn grid_intervals(&self) -> usize {
        self.motions.iter().map(SectionMotion::intervals).sum()
    }

    /// State of the joints `t` seconds after the start: rad, rad/s and rad/s² (m for prismatic joints). Before the
    /// start the first state, after the end (and for NaN) the last.
    pub fn at(&self, t: f64) -> TrajectoryPoint {
        let joints = self.path.joints();
        if !(t < self.seconds()) {
            return TrajectoryPoint::at_rest(self.path.end.clone());
        }
        if t <= 0.0 {
            return TrajectoryPoint::at_rest(self.path.start.clone());
        }
        let section = (self.times.partition_point(|time| *time <= t) - 1).min(self.motions.len() - 1);
        let ([s, v, a, _], element) = self.motions[section].at(t - self.times[section]);
        let element = &self.path.sections[section].elements[element];
        let mut point = TrajectoryPoint {
            q: Vec::with_capacity(joints),
            dq: Vec::with_capacity(joints),
            ddq: Vec::with_capacity(joints),
        };
        for joint in 0..joints {
            let [q, p, c, _] = element.at(s, joint);
            point.q.push(q);
            point.dq.push(p * v);
            point.ddq.push(p * a + c * v * v);
        }
        point
    }

    /// Slows the trajectory down slightly, so that it rests only at multiples of a period (s): each part from rest to
    /// rest takes less than a period longer.
    ///
    /// # Errors
    /// The period is not a finite number above 0.
    pub fn aligned_to_ticks(mut self, period: f64) -> Result<Self, TimeParametrizationError> {
        validate_period(period)?;
        let mut ticks = 0.0;
        for (n, motion) in self.motions.iter_mut().enumerate() {
            let count = periods(motion.seconds(), period).max(1.0);
            motion.rate *= (motion.seconds() / (count * period)).min(1.0);
            ticks += count;
            self.times[n + 1] = ticks * period;
        }
        Ok(self)
    }

    /// Positions (rad, m for prismatic joints) at every period (s) from 0 to the end. With linear interpolation between
    /// them, no joint is faster than its limit.
    ///
    /// # Errors
    /// The period is not a finite number above 0.
    pub fn samples(&self, period: f64) -> Result<JointTrajectory, TimeParametrizationError> {
        sampled(self.seconds(), period, |t| self.at(t).q)
    }
}
