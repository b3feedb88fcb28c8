//! An escape: every joint moves to its target in the least time, then rests.

use elbowroom_kinematics::JointLimits;

use crate::joint_limits::stop_s;
use crate::joint_profile::JointProfile;
use crate::reversal_limiter::ReversalLimiter;

/// Configuration, velocity and limits from which an escape begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EscapeStart<'a> {
    /// Joint values, rad or m.
    pub(crate) q: &'a [f64],
    /// Joint velocities, rad/s or m/s.
    pub(crate) qd: &'a [f64],
    pub(crate) limits: &'a [JointLimits],
    /// Fraction of the top speeds that the override of a monitor permits, 0 to 1.
    pub(crate) speed_share: f64,
    pub(crate) reversals: &'a ReversalLimiter,
}

/// Joint values over time.
#[derive(Debug, Clone)]
pub(crate) struct EscapeTrajectory {
    profiles: Vec<JointProfile>,
    /// Time until all joints rest, s.
    pub(crate) duration_s: f64,
    /// Largest speed of each joint, rad/s or m/s.
    pub(crate) max_speeds: Vec<f64>,
}

impl EscapeTrajectory {
    pub(crate) fn new(joints: usize) -> Self {
        Self { profiles: vec![JointProfile::default(); joints], duration_s: 0.0, max_speeds: vec![0.0; joints] }
    }

    /// Moves to rest at a configuration, each joint in its least time.
    pub(crate) fn set_target(&mut self, target: &[f64], start: &EscapeStart<'_>) {
        for (j, profile) in self.profiles.iter_mut().enumerate() {
            let full = &start.limits[j];
            let limit = full.slowed_to(start.speed_share);
            let wait_s = |direction| start.reversals.wait_s(j, start.qd[j], full.velocity, direction);
            *profile = JointProfile::to_rest_at(target[j], start.q[j], start.qd[j], &limit, wait_s);
        }
        self.update_summary();
    }

    /// Stops at the deceleration of a stop, all joints together.
    pub(crate) fn set_stop(&mut self, start: &EscapeStart<'_>) {
        let stop_s = stop_s(start.limits, start.qd);
        for (profile, (q, qd)) in self.profiles.iter_mut().zip(start.q.iter().zip(start.qd)) {
            *profile = JointProfile::stop(*q, *qd, stop_s);
        }
        self.update_summary();
    }

    fn update_summary(&mut self) {
        self.duration_s = self.profiles.iter().map(JointProfile::duration_s).fold(0.0, f64::max);
        self.max_speeds.iter_mut().zip(&self.profiles).for_each(|(max, p)| *max = p.max_speed);
    }

    /// Whether all joints are within `tolerance` of their values after `t_s` seconds.
    pub(crate) fn is_near(&self, t_s: f64, q: &[f64], tolerance: f64) -> bool {
        q.iter().zip(&self.profiles).all(|(q, p)| (p.at(t_s).0 - q).abs() <= tolerance)
    }

    /// Writes a bound of the deviation from a straight motion between two times to `out`, rad or m per joint.
    pub(crate) fn chord_deviation(&self, from_s: f64, to_s: f64, out: &mut [f64]) {
        let square = (to_s - from_s) * (to_s - from_s);
        out.iter_mut().zip(&self.profiles).for_each(|(d, p)| *d = p.max_acceleration(from_s, to_s) * square / 8.0);
    }

    /// Writes the joint values and velocities after `t_s` seconds.
    pub(crate) fn state_at(&self, t_s: f64, q: &mut [f64], qd: &mut [f64]) {
        for (j, profile) in self.profiles.iter().enumerate() {
            (q[j], qd[j]) = profile.at(t_s);
        }
    }

    /// Writes the joint values after `t_s` seconds.
    pub(crate) fn q_at(&self, t_s: f64, out: &mut [f64]) {
        out.iter_mut().zip(&self.profiles).for_each(|(q, p)| *q = p.at(t_s).0);
    }
}
