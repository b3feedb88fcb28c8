//! The speed along a straight segment: a ramp up, a constant speed, a ramp down.

use super::speed_ramp::SpeedRamp;
use elbowroom_kinematics::JointLimits;

/// Number of bisections: enough to reach the rounding error of any speed.
const BISECTIONS: usize = 60;

/// Speed as a function of time on a straight segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct SpeedProfile {
    up: SpeedRamp,
    down: SpeedRamp,
    peak: f64,
    /// Time at the peak speed, s.
    hold: f64,
}

impl SpeedProfile {
    /// The fastest profile from one speed to another over a length, which must be sufficient for the change.
    pub fn new(length: f64, from: f64, to: f64, limits: JointLimits) -> Self {
        let ramps = |peak: f64| (SpeedRamp::new(from, peak, limits), SpeedRamp::new(peak, to, limits));
        let over = |peak: f64| {
            let (up, down) = ramps(peak);
            up.distance() + down.distance()
        };
        let peak = bisect_greatest(from.max(to), limits.velocity, |peak| over(peak) <= length);
        let (up, down) = ramps(peak);
        let rest = (length - up.distance() - down.distance()).max(0.0);
        Self { up, down, peak, hold: if peak > 0.0 { rest / peak } else { 0.0 } }
    }

    pub fn seconds(&self) -> f64 {
        self.up.seconds + self.hold + self.down.seconds
    }

    /// Distance, speed and acceleration after `t` seconds.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let held = t - self.up.seconds;
        if held < 0.0 {
            return self.up.at(t);
        }
        let up = self.up.distance();
        if held < self.hold {
            return [up + self.peak * held, self.peak, 0.0];
        }
        let [s, v, a] = self.down.at(held - self.hold);
        [up + self.peak * self.hold + s, v, a]
    }
}

/// Finds the greatest value of `low..=high` for which a monotonic condition holds; it must hold for `low`.
pub(super) fn bisect_greatest(low: f64, high: f64, holds: impl Fn(f64) -> bool) -> f64 {
    if low >= high || holds(high) {
        return high.max(low);
    }
    let (mut good, mut bad) = (low, high);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (good + bad);
        if holds(middle) { good = middle } else { bad = middle }
    }
    good
}
