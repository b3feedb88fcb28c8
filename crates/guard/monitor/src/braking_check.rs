//! Check that the robot brakes as fast as stated.

/// Tolerance of the measured stop time, s.
const TOLERANCE_S: f64 = 0.01;
/// Tolerance of the measured stop time, as a fraction of it.
const TOLERANCE_FRACTION: f64 = 0.05;

/// Compares the robot's stop time with the largest one that is allowed: it falls by one second per second, down to the stop
/// time of the commanded override.
#[derive(Debug, Default)]
pub(crate) struct BrakingCheck {
    /// Time stamp and stop time of the last update, s.
    last: Option<(f64, f64)>,
    allowed_s: f64,
    failed: bool,
}

impl BrakingCheck {
    /// At `stamp_s` the robot has the stop time `stop_s`; `commanded_s` is the largest stop time at the commanded overrides.
    pub(crate) fn update(&mut self, stamp_s: f64, stop_s: f64, commanded_s: f64) {
        let reduced_s = self
            .last
            .map_or(stop_s, |(last_stamp_s, last_stop_s)| last_stop_s.min(self.allowed_s) - (stamp_s - last_stamp_s));
        self.allowed_s = reduced_s.max(commanded_s).max(0.0);
        self.failed = stop_s > self.allowed_s * (1.0 + TOLERANCE_FRACTION) + TOLERANCE_S;
        self.last = Some((stamp_s, stop_s));
    }

    pub(crate) fn failed(&self) -> bool {
        self.failed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stop commanded at 0.1 s: the stop time of 0.5 s falls at `rate`.
    fn failed(rate: f64) -> bool {
        let mut check = BrakingCheck::default();
        (0..300).any(|i| {
            let t = 0.002 * f64::from(i);
            let braking = t - 0.1;
            let commanded = if braking < 0.0 { 0.5 } else { 0.0 };
            check.update(t, (0.5 - rate * braking.max(0.0)).max(0.0), commanded);
            check.failed()
        })
    }

    #[test]
    fn braking_a_tenth_below_the_stated_rate_is_detected() {
        assert!(!failed(1.0) && !failed(3.0));
        assert!(failed(0.9) && failed(0.0));
    }
}
