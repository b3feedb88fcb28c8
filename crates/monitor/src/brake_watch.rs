//! Does the robot brake as was stated?

/// Readings of velocities are not exact: this much of stop time (s), and this share of it, is let pass.
const TOLERANCE_S: f64 = 0.01;
const TOLERANCE_SHARE: f64 = 0.05;

/// Compares the robot's stop time n with the one that it must have come down to: by a second per second, or to what it was
/// told.
#[derive(Debug, Default)]
pub(crate) struct BrakeWatch {
    last: Option<(f64, f64)>,
    allowed_s: f64,
    failed: bool,
}

impl BrakeWatch {
    /// At `stamp_s` the robot has the stop time `stop_s`, and may have `told_s` by all that it was told.
    pub(crate) fn look(&mut self, stamp_s: f64, stop_s: f64, told_s: f64) {
        let fallen = self.last.map_or(stop_s, |(then_s, was_s)| was_s.min(self.allowed_s) - (stamp_s - then_s));
        self.allowed_s = fallen.max(told_s).max(0.0);
        self.failed = stop_s > self.allowed_s * (1.0 + TOLERANCE_SHARE) + TOLERANCE_S;
        self.last = Some((stamp_s, stop_s));
    }

    pub(crate) fn failed(&self) -> bool {
        self.failed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Told to stop at 0.1 s: stop time 0.5 s, falling at `rate`.
    fn failed(rate: f64) -> bool {
        let mut watch = BrakeWatch::default();
        (0..300).any(|i| {
            let t = 0.002 * f64::from(i);
            let braking = t - 0.1;
            let told = if braking < 0.0 { 0.5 } else { 0.0 };
            watch.look(t, (0.5 - rate * braking.max(0.0)).max(0.0), told);
            watch.failed()
        })
    }

    #[test]
    fn a_robot_that_brakes_a_tenth_too_little_is_found() {
        assert!(!failed(1.0) && !failed(3.0));
        assert!(failed(0.9) && failed(0.0));
    }
}
