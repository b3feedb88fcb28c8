//! Changes of speed: the acceleration rises, stays constant and falls again; it is 0 at both ends.

use elbowroom_kinematics::JointLimits;

/// The fastest change from one speed to another within limits of acceleration and jerk.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpeedRamp {
    from: f64,
    to: f64,
    /// Time for which the acceleration rises, and equally falls, s.
    rise: f64,
    pub seconds: f64,
}

impl SpeedRamp {
    pub fn new(from: f64, to: f64, limits: JointLimits) -> Self {
        let change = (to - from).abs();
        let rise = (limits.acceleration / limits.jerk).min((change / limits.jerk).sqrt());
        let seconds = if rise > 0.0 { change / (limits.jerk * rise) + rise } else { 0.0 };
        Self { from, to, rise, seconds }
    }

    pub fn distance(&self) -> f64 {
        0.5 * (self.from + self.to) * self.seconds
    }

    /// Distance, speed and acceleration after `t` seconds.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let (rise, all) = (self.rise, self.seconds);
        if !(t > 0.0) || all == 0.0 {
            return [0.0, self.from, 0.0];
        }
        let jerk = (self.to - self.from) / (rise * (all - rise));
        if t < rise {
            return [self.from * t + jerk * t.powi(3) / 6.0, self.from + jerk * t * t * 0.5, jerk * t];
        }
        let left = all - t;
        if left < rise {
            let left = left.max(0.0);
            let rest = self.to * left - jerk * left.powi(3) / 6.0;
            return [self.distance() - rest, self.to - jerk * left * left * 0.5, jerk * left];
        }
        let (hold, a) = (t - rise, jerk * rise);
        let risen = self.from * t + jerk * rise.powi(3) / 6.0;
        [risen + a * rise * 0.5 * hold + a * hold * hold * 0.5, self.from + a * (0.5 * rise + hold), a]
    }
}
