//! The commanded motion of the joints.

use elbowroom_kinematics::JointLimits;

/// The commanded motion of the joints.
#[derive(Debug)]
pub(crate) struct JointCommand {
    pub(crate) q: Vec<f64>,
    pub(crate) qd: Vec<f64>,
    pub(crate) qdd: Vec<f64>,
    /// Joint velocities at override 1.
    pub(crate) intent: Vec<f64>,
}

impl JointCommand {
    pub(crate) fn at_rest(q: &[f64]) -> Self {
        let zeros = || vec![0.0; q.len()];
        Self { q: q.to_vec(), qd: zeros(), qdd: zeros(), intent: zeros() }
    }

    /// Stops at the present joint values.
    pub(crate) fn stop(&mut self) {
        self.qd.fill(0.0);
        self.qdd.fill(0.0);
    }

    /// Moves at the velocities `next` for `dt` seconds; the joint values of a reference are copied exactly.
    pub(crate) fn advance(&mut self, dt: f64, next: &[f64], limits: &[JointLimits], reference_q: Option<&[f64]>) {
        for (j, limit) in limits.iter().enumerate() {
            let unlimited = self.q[j] + next[j] * dt;
            let limited = unlimited.clamp(limit.lower, limit.upper);
            // A joint that stops at its limit moves more slowly than commanded.
            let v = if limited == unlimited { next[j] } else { (limited - self.q[j]) / dt };
            self.qdd[j] = (v - self.qd[j]) / dt;
            self.qd[j] = v;
            self.q[j] = reference_q.map_or(limited, |q| q[j]);
        }
    }
}
