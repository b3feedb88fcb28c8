//! Limits how often the joints reverse, so that the robot does not oscillate.

use crate::VelocityBounds;

/// Speed, as a fraction of the top speed, below which a joint is at rest.
const REST_FRACTION: f64 = 1e-4;

/// The direction of each joint and the time since its last reversal.
#[derive(Debug, Clone)]
pub(crate) struct ReversalLimiter {
    min_interval_s: f64,
    sign: Vec<f64>,
    since_s: Vec<f64>,
}

impl ReversalLimiter {
    /// Creates a limiter with at least `min_interval_s` seconds between reversals of a joint.
    pub(crate) fn new(joints: usize, min_interval_s: f64) -> Self {
        Self { min_interval_s, sign: vec![0.0; joints], since_s: vec![f64::INFINITY; joints] }
    }

    /// Removes the reverse direction from the bounds of joints that reversed recently.
    pub(crate) fn restrict(&self, bounds: &mut VelocityBounds) {
        for (j, [low, high]) in bounds.next.iter_mut().enumerate() {
            if self.since_s[j] >= self.min_interval_s {
                continue;
            }
            if self.sign[j] > 0.0 {
                (*low, *high) = (low.max(0.0), high.max(0.0));
            } else {
                (*low, *high) = (low.min(0.0), high.min(0.0));
            }
        }
    }

    /// Time until a joint that moves at `qd` may move in a direction (±1), s; `speed` is its top speed. `qd` may be a
    /// velocity that is not recorded yet.
    pub(crate) fn wait_s(&self, joint: usize, qd: f64, speed: f64, direction: f64) -> f64 {
        let moves = qd.abs() > REST_FRACTION * speed;
        let (sign, since_s) = match self.sign[joint] {
            sign if moves && sign * qd < 0.0 => (qd.signum(), 0.0),
            sign => (sign, self.since_s[joint]),
        };
        if sign * direction < 0.0 { (self.min_interval_s - since_s).max(0.0) } else { 0.0 }
    }

    /// Whether a motion from rest reverses only joints that have not reversed recently.
    pub(crate) fn allows(&self, velocity: impl Iterator<Item = f64>) -> bool {
        let mut joints = velocity.zip(&self.sign).zip(&self.since_s);
        joints.all(|((v, sign), since)| v * sign >= 0.0 || *since >= self.min_interval_s)
    }

    /// Records the commanded velocities; `speeds` are the top speeds of the joints.
    pub(crate) fn record(&mut self, qd: &[f64], speeds: impl Iterator<Item = f64>, dt: f64) {
        for (j, (v, speed)) in qd.iter().zip(speeds).enumerate() {
            self.since_s[j] += dt;
            if v.abs() <= REST_FRACTION * speed {
                continue;
            }
            let sign = v.signum();
            if self.sign[j] * sign < 0.0 {
                self.since_s[j] = 0.0;
            }
            self.sign[j] = sign;
        }
    }
}
