//! Time-optimal motion of one joint to rest at a target: full acceleration, cruise at top speed, full deceleration.

use elbowroom_kinematics::JointLimits;

/// A stretch of constant acceleration.
#[derive(Debug, Clone, Copy, Default)]
struct Phase {
    duration_s: f64,
    acceleration: f64,
}

/// Joint value over time, at piecewise constant acceleration (a trapezoidal velocity profile); at rest after the last phase.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct JointProfile {
    q: f64,
    qd: f64,
    /// Brake, dwell, accelerate, cruise, brake.
    phases: [Phase; 5],
    /// Largest speed, rad/s or m/s.
    pub(crate) max_speed: f64,
}

impl JointProfile {
    /// Moves from `q` at the velocity `qd` to rest at `target`, as fast as the limit permits. A joint that moves away
    /// from the target, or too fast to stop there, stops first and reverses. `reversal_wait_s` returns the time before
    /// it may move in a direction (±1).
    pub(crate) fn to_rest_at(
        target: f64,
        q: f64,
        qd: f64,
        limit: &JointLimits,
        reversal_wait_s: impl Fn(f64) -> f64,
    ) -> Self {
        let stop_s = qd.abs() / limit.stop;
        let stops_at = q + 0.5 * qd * stop_s;
        let left = target - stops_at;
        let mut profile = Self { q, qd, max_speed: qd.abs(), ..Self::default() };
        if qd * left > 0.0 {
            profile.ramp((target - q).abs(), qd.abs(), qd.signum(), limit);
        } else {
            profile.phases[0] = Phase { duration_s: stop_s, acceleration: -qd.signum() * limit.stop };
            if left != 0.0 {
                profile.phases[1].duration_s = (reversal_wait_s(left.signum()) - stop_s).max(0.0);
                profile.ramp(left.abs(), 0.0, left.signum(), limit);
            }
        }
        profile
    }

    /// Stops in `stop_s` seconds at constant deceleration.
    pub(crate) fn stop(q: f64, qd: f64, stop_s: f64) -> Self {
        let acceleration = if stop_s > 0.0 { -qd / stop_s } else { 0.0 };
        let mut profile = Self { q, qd, max_speed: qd.abs(), ..Self::default() };
        profile.phases[0] = Phase { duration_s: stop_s, acceleration };
        profile
    }

    /// Adds phases that accelerate, cruise and brake over `distance` in the direction `sign`, from the speed `speed` to
    /// rest.
    fn ramp(&mut self, distance: f64, speed: f64, sign: f64, limit: &JointLimits) {
        let (a, d) = (limit.acceleration, limit.stop);
        // v²/(2a) − speed²/(2a) + v²/(2d) = distance
        let reachable = ((2.0 * distance + speed * speed / a) / (1.0 / a + 1.0 / d)).sqrt();
        let top = reachable.min(limit.velocity);
        // If the joint is faster than the top speed (a lower override), it slows down first.
        let rate = if speed > top { -d } else { a };
        let changed = (top * top - speed * speed) / (2.0 * rate);
        let cruise = (distance - changed - top * top / (2.0 * d)).max(0.0);
        self.phases[2] = Phase { duration_s: (top - speed) / rate, acceleration: sign * rate };
        self.phases[3].duration_s = if top > 0.0 { cruise / top } else { 0.0 };
        self.phases[4] = Phase { duration_s: top / d, acceleration: -sign * d };
        self.max_speed = self.max_speed.max(top);
    }

    /// Time until rest at the target, s.
    pub(crate) fn duration_s(&self) -> f64 {
        self.phases.iter().map(|p| p.duration_s).sum()
    }

    /// Largest acceleration from `from_s` to `to_s`, rad/s² or m/s².
    pub(crate) fn max_acceleration(&self, from_s: f64, to_s: f64) -> f64 {
        let (mut begin, mut max) = (0.0, 0.0_f64);
        for phase in &self.phases {
            let end = begin + phase.duration_s;
            if begin < to_s && end > from_s {
                max = max.max(phase.acceleration.abs());
            }
            begin = end;
        }
        max
    }

    /// Joint value and velocity after `t_s` seconds.
    pub(crate) fn at(&self, t_s: f64) -> (f64, f64) {
        let (mut q, mut qd, mut left) = (self.q, self.qd, t_s);
        for phase in &self.phases {
            let t = left.clamp(0.0, phase.duration_s);
            q += (qd + 0.5 * phase.acceleration * t) * t;
            qd += phase.acceleration * t;
            left -= t;
        }
        (q, if left > 0.0 { 0.0 } else { qd })
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_testkit::random::SplitMix;

    use super::*;

    /// The least time by brute force: towards full speed in one direction, then in the other, each for a number of
    /// steps.
    fn fastest_of_many(distance: f64, speed: f64, limit: &JointLimits) -> f64 {
        let mut best = f64::INFINITY;
        for n in 0..=4000 {
            let top = limit.velocity * f64::from(n) / 4000.0;
            if top < speed {
                continue;
            }
            let up = (top * top - speed * speed) / (2.0 * limit.acceleration);
            let cruise = distance - up - top * top / (2.0 * limit.stop);
            if cruise >= 0.0 && top > 0.0 {
                best = best.min((top - speed) / limit.acceleration + cruise / top + top / limit.stop);
            }
        }
        best
    }

    #[test]
    fn profiles_end_at_rest_at_the_target_within_the_limits_and_none_is_faster() {
        let mut random = SplitMix(3);
        let limit = JointLimits::new(2.0, 6.0, f64::INFINITY).within(-9.0, 9.0).stopping_at(15.0);
        let mut direct = 0;
        for case in 0..2_000 {
            let (q, qd, target) = (random.between(-2.0, 2.0), random.between(-2.0, 2.0), random.between(-3.0, 3.0));
            let profile = JointProfile::to_rest_at(target, q, qd, &limit, |_| 0.1);
            let duration = profile.duration_s();
            let (end, at_end) = profile.at(duration + 1.0);
            assert!((end - target).abs() < 1e-9 && at_end == 0.0, "case {case}: {end} {target} {at_end}");
            let dt = 1e-3;
            for n in 0..(duration / dt) as u32 {
                let (v0, v1) = (profile.at(f64::from(n) * dt).1, profile.at(f64::from(n + 1) * dt).1);
                assert!(v1.abs() <= profile.max_speed + 1e-9 && profile.max_speed <= 2.0 + 1e-9);
                let speeding_up = v1.abs() > v0.abs() && v0 * v1 >= 0.0;
                let rate = (v1 - v0).abs() / dt;
                assert!(rate <= if speeding_up { 6.0 } else { 15.0 } + 1e-6, "case {case}: {v0} {v1}");
            }
            // The position agrees with the integral of the velocity.
            let steps = 2_000;
            let h = duration / f64::from(steps);
            let travel: f64 = (0..steps).map(|n| profile.at((f64::from(n) + 0.5) * h).1 * h).sum();
            assert!((q + travel - target).abs() < 1e-3, "case {case}");
            if qd > 0.0 && target - q > qd * qd / 30.0 {
                direct += 1;
                let best = fastest_of_many(target - q, qd, &limit);
                assert!(duration <= best + 1e-9 && duration > best - 2e-2, "case {case}: {duration} {best}");
            }
        }
        assert!(direct > 200);
    }

    #[test]
    fn a_joint_rests_before_it_reverses() {
        let limit = JointLimits::new(2.0, 4.0, f64::INFINITY).within(-9.0, 9.0).stopping_at(10.0);
        let profile =
            JointProfile::to_rest_at(-1.0, 0.0, 1.0, &limit, |direction| if direction < 0.0 { 0.25 } else { 0.0 });
        // The joint stops in 0.1 s at 0.05 rad and rests for the remaining 0.15 s.
        assert!((profile.at(0.1).0 - 0.05).abs() < 1e-12);
        assert_eq!(profile.at(0.2), (profile.at(0.1).0, profile.at(0.2).1));
        assert!(profile.at(0.2).1.abs() < 1e-12 && profile.at(0.26).1 < 0.0);
    }
}
