//! Check that the robot brakes as fast as its configuration states.

/// Tolerance of the measured stop time, s.
const TOLERANCE_S: f64 = 0.01;
/// Tolerance of the measured stop time, as a fraction of it.
const TOLERANCE_FRACTION: f64 = 0.05;

/// Compares the robot's stop time with the largest allowed one, which falls by one second per second, down to the
/// stop time of the commanded override.
#[derive(Debug, Default)]
pub(crate) struct BrakingCheck {
    last: Option<Braking>,
    allowed_s: f64,
    failed: bool,
}

/// The measured stop time of a robot and the override commanded to it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Braking {
    /// Time stamp of the joint values, s.
    pub(crate) stamp_s: f64,
    /// The robot's stop time, s.
    pub(crate) stop_s: f64,
    /// The largest override that may be in effect.
    pub(crate) commanded: f64,
    /// Time from which no larger override may be in effect, s.
    pub(crate) commanded_since_s: f64,
    /// Stop time of the program at override 1, s; infinite if it is not known.
    pub(crate) full_stop_s: f64,
    /// Time over which the velocities were derived from positions, s; 0 if they were given.
    pub(crate) uncertain_s: f64,
}

impl BrakingCheck {
    pub(crate) fn update(&mut self, now: Braking) {
        let allowed_s = |last: &Braking| {
            let braked_s = last.stop_s.min(self.allowed_s) - (now.stamp_s - last.stamp_s);
            // Until `since_s` the robot may have run at the previous override; it brakes only from then on.
            let since_s = now.commanded_since_s.clamp(last.stamp_s, now.stamp_s.max(last.stamp_s));
            let went_on_s = stop_at(last.commanded, last.full_stop_s.max(now.full_stop_s)) - (now.stamp_s - since_s);
            braked_s.max(went_on_s)
        };
        let reduced_s = self.last.as_ref().map_or(now.stop_s, allowed_s);
        self.allowed_s = reduced_s.max(stop_at(now.commanded, now.full_stop_s)).max(0.0);
        self.failed = now.stop_s > self.allowed_s * (1.0 + TOLERANCE_FRACTION) + TOLERANCE_S + now.uncertain_s;
        self.last = Some(now);
    }

    pub(crate) fn failed(&self) -> bool {
        self.failed
    }
}

/// The stop time at an override, s.
fn stop_at(speed_override: f64, full_stop_s: f64) -> f64 {
    if speed_override > 0.0 { speed_override * full_stop_s } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ticks of `tick_s` of a robot whose stop time is 0.5 s until a stop takes effect at `since_s`; then it falls at `rate`.
    fn failed(rate: f64, tick_s: f64, since_s: f64) -> bool {
        let mut check = BrakingCheck::default();
        (0..(0.7 / tick_s) as u32).any(|i| {
            let stamp_s = tick_s * f64::from(i);
            let braking_s = stamp_s - since_s;
            let commanded = if braking_s < 0.0 { 1.0 } else { 0.0 };
            let commanded_since_s = if braking_s < 0.0 { 0.0 } else { since_s };
            let stop_s = (0.5 - rate * braking_s.max(0.0)).max(0.0);
            check.update(Braking { stamp_s, stop_s, commanded, commanded_since_s, full_stop_s: 0.5, uncertain_s: 0.0 });
            check.failed()
        })
    }

    /// Derived velocities are valid for the middle of a tick, so the robot seems to brake late.
    #[test]
    fn derived_velocities_are_no_weaker_brakes() {
        let (tick_s, full_stop_s) = (0.04, 0.1);
        let mut check = BrakingCheck::default();
        for i in 0..20 {
            let stamp_s = tick_s * f64::from(i);
            let stop_s = (full_stop_s - (stamp_s - 0.2 - 0.5 * tick_s).max(0.0)).max(0.0);
            let commanded = if stamp_s < 0.2 { 1.0 } else { 0.0 };
            let commanded_since_s = if stamp_s < 0.2 { 0.0 } else { 0.2 };
            check.update(Braking { stamp_s, stop_s, commanded, commanded_since_s, full_stop_s, uncertain_s: tick_s });
            assert!(!check.failed(), "at {stamp_s} s");
        }
    }

    #[test]
    fn braking_a_tenth_below_the_stated_rate_is_detected() {
        for tick_s in [0.002, 0.008, 0.04] {
            for since_s in [0.1, 0.101, 0.119, 0.1199] {
                assert!(!failed(1.0, tick_s, since_s) && !failed(3.0, tick_s, since_s), "{tick_s}, {since_s}");
                assert!(failed(0.85, tick_s, since_s) && failed(0.0, tick_s, since_s), "{tick_s}, {since_s}");
            }
        }
        assert!(failed(0.9, 0.002, 0.1));
    }
}
