//! A planned detour that the robot follows.

use elbowroom_kinematics::JointLimits;

use crate::joint_limits::{arrival_speed, distance_s, speed_fraction};
use crate::reversal_limiter::ReversalLimiter;

/// Distance up to which two configurations count as equal, in seconds of joint motion at full speed.
pub(crate) const SAME_CONFIGURATION_S: f64 = 1e-9;

/// Configuration, velocities and limits of the joints.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointState<'a> {
    /// Joint values, rad or m.
    pub(crate) q: &'a [f64],
    /// Joint velocities, rad/s or m/s.
    pub(crate) qd: &'a [f64],
    pub(crate) limits: &'a [JointLimits],
}

/// The remaining waypoints of a detour: straight motions from waypoint to waypoint, with a stop at each.
#[derive(Debug, Clone, Default)]
pub(crate) struct Detour {
    /// The next waypoint is the last element.
    waypoints: Vec<Vec<f64>>,
    /// Present speed as a fraction of the top speeds.
    speed: f64,
}

impl Detour {
    /// A detour through the waypoints. A robot that is not at the first waypoint moves there first.
    pub(crate) fn new(mut waypoints: Vec<Vec<f64>>, is_at_first: bool) -> Self {
        waypoints.reverse();
        if is_at_first {
            waypoints.pop();
        }
        Self { waypoints, speed: 0.0 }
    }

    /// Whether no waypoint remains.
    pub(crate) fn is_finished(&self) -> bool {
        self.waypoints.is_empty()
    }

    /// Discards the remaining waypoints.
    pub(crate) fn abandon(&mut self) {
        self.waypoints.clear();
    }

    /// Writes the next velocity to `out`: all joints move together, with ramps between the stops, at most at
    /// `max_speed` (a fraction of the top speeds).
    pub(crate) fn follow(
        &mut self,
        dt: f64,
        max_speed: f64,
        now: &JointState<'_>,
        reversals: &ReversalLimiter,
        out: &mut [f64],
    ) {
        let JointState { q, qd, limits } = *now;
        // After braking it continues from the remaining speed.
        self.speed = self.speed.min(speed_fraction(qd, limits));
        let longest = |f: fn(&JointLimits) -> f64| limits.iter().map(f).fold(0.0, f64::max);
        let (rise_s, stop_s) = (longest(|l| l.velocity / l.acceleration), longest(|l| l.velocity / l.stop));
        out.fill(0.0);
        while let Some(waypoint) = self.waypoints.last() {
            let remaining_s = distance_s(waypoint, q, limits);
            let difference = || waypoint.iter().zip(q).map(|(to, from)| to - from);
            if remaining_s > SAME_CONFIGURATION_S {
                // From rest it starts only when the joints may reverse.
                if self.speed > 0.0 || reversals.allows(difference()) {
                    let target =
                        arrival_speed(remaining_s, rise_s).min(max_speed).min(stopping_speed(remaining_s, stop_s, dt));
                    self.speed = target.clamp((self.speed - dt / stop_s).max(0.0), self.speed + dt / rise_s);
                    // The last step ends at the waypoint, not beyond it.
                    let rate = (self.speed / remaining_s).min(1.0 / dt);
                    out.iter_mut().zip(difference()).for_each(|(v, d)| *v = d * rate);
                }
                return;
            }
            self.waypoints.pop();
            self.speed = 0.0;
        }
    }
}

/// Speed fraction from which a stop after this tick ends within the remaining distance: `v·dt + v²/(2a) = remaining`.
fn stopping_speed(remaining_s: f64, stop_s: f64, dt: f64) -> f64 {
    2.0 * remaining_s / (dt + (dt * dt + 2.0 * remaining_s * stop_s).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn after_braking_it_continues_from_the_remaining_speed() {
        let limits = [JointLimits::new(2.0, 8.0, f64::INFINITY).within(-9.0, 9.0).stopping_at(20.0); 2];
        let (reversals, dt) = (ReversalLimiter::new(2, 0.25), 0.004);
        let mut detour = Detour::new(vec![vec![0.0, 0.0], vec![1.0, -0.5], vec![1.5, 0.5]], true);
        let (mut q, mut qd) = ([0.0, 0.0], [0.0, 0.0]);
        let mut next = [0.0, 0.0];
        let mut ticks = 0;
        while !detour.is_finished() {
            detour.follow(dt, 0.5, &JointState { q: &q, qd: &qd, limits: &limits }, &reversals, &mut next);
            // The robot brakes from time to time.
            if (20..24).contains(&(ticks % 50)) {
                crate::joint_limits::brake(&limits, &[[-9.0, 9.0]; 2], &qd, dt, &mut next);
            }
            for j in 0..2 {
                let rate = (next[j] - qd[j]) / dt;
                assert!(rate.abs() <= 20.0 * (1.0 + 1e-9), "tick {ticks}: {rate}");
                assert!(next[j].abs() <= 1.0 + 1e-9);
                let acceleration = (next[j].abs() - qd[j].abs()) / dt;
                assert!(acceleration <= 8.0 * (1.0 + 1e-9), "tick {ticks}: {acceleration}");
                q[j] += next[j] * dt;
            }
            qd = next;
            ticks += 1;
            assert!(ticks < 5_000);
        }
        assert!((q[0] - 1.5).abs() < 1e-6 && (q[1] - 0.5).abs() < 1e-6, "{q:?}");
    }
}
