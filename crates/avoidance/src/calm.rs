//! No shaking: a joint does not turn back twice in a short while.

use crate::VelocityBounds;

/// Slower than this share of its top speed a joint counts as standing.
const STANDS: f64 = 1e-4;

/// When each joint last turned back.
#[derive(Debug, Clone)]
pub struct Calm {
    quiet_s: f64,
    sign: Vec<f64>,
    since_s: Vec<f64>,
}

impl Calm {
    /// Reversals of a joint are at least `quiet_s` seconds apart.
    pub fn new(joints: usize, quiet_s: f64) -> Self {
        Self { quiet_s, sign: vec![0.0; joints], since_s: vec![f64::INFINITY; joints] }
    }

    /// Takes the way back out of the bounds of joints that turned back just now.
    pub fn hold(&self, bounds: &mut VelocityBounds) {
        for (j, [low, high]) in bounds.now.iter_mut().enumerate() {
            if self.since_s[j] >= self.quiet_s {
                continue;
            }
            if self.sign[j] > 0.0 {
                (*low, *high) = (low.max(0.0), high.max(0.0));
            } else {
                (*low, *high) = (low.min(0.0), high.min(0.0));
            }
        }
    }

    /// True where a motion from rest turns no joint back that turned back just now.
    pub fn allows(&self, velocity: impl Iterator<Item = f64>) -> bool {
        let mut joints = velocity.zip(&self.sign).zip(&self.since_s);
        joints.all(|((v, sign), since)| v * sign >= 0.0 || *since >= self.quiet_s)
    }

    /// What was commanded.
    pub fn note(&mut self, qd: &[f64], speeds: impl Iterator<Item = f64>, dt: f64) {
        for (j, (v, speed)) in qd.iter().zip(speeds).enumerate() {
            self.since_s[j] += dt;
            if v.abs() <= STANDS * speed {
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
