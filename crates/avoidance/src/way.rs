//! A planned way that is gone along.

use crate::calm::Calm;
use crate::joint::{JointLimit, astray, share, slowing};

/// A deviation of so many seconds at full joint speed is none.
pub const NONE_S: f64 = 1e-9;

/// A robot on its way.
#[derive(Debug, Clone, Copy)]
pub struct Moving<'a> {
    /// Joint values, rad or m.
    pub q: &'a [f64],
    /// Their velocities, rad/s or m/s.
    pub qd: &'a [f64],
    pub limits: &'a [JointLimit],
}

/// Waypoints that are still to come: straight from one to the next, with a stop at each.
#[derive(Debug, Clone, Default)]
pub struct Way {
    /// The next one last.
    waypoints: Vec<Vec<f64>>,
    /// Speed, as a share of the fastest.
    share: f64,
}

impl Way {
    /// From the first of these, where the robot stands, to the last.
    pub fn new(mut waypoints: Vec<Vec<f64>>) -> Self {
        waypoints.reverse();
        waypoints.pop();
        Self { waypoints, share: 0.0 }
    }

    /// True where nothing of it is left.
    pub fn is_empty(&self) -> bool {
        self.waypoints.is_empty()
    }

    /// Gives it up.
    pub fn clear(&mut self) {
        self.waypoints.clear();
    }

    /// The next velocity, in `out`, all joints together, with ramps between the stops: at most `most` as a share of the
    /// joints' speeds.
    pub fn follow(&mut self, dt: f64, most: f64, now: &Moving<'_>, calm: &Calm, out: &mut [f64]) {
        let Moving { q, qd, limits } = *now;
        // What was braked since goes on from the speed that is left.
        self.share = self.share.min(share(qd, limits));
        let slowest = |f: fn(&JointLimit) -> f64| limits.iter().map(f).fold(0.0, f64::max);
        let (rise_s, stop_s) = (slowest(|l| l.speed / l.acceleration), slowest(|l| l.speed / l.stop));
        out.fill(0.0);
        while let Some(waypoint) = self.waypoints.last() {
            let left_s = astray(waypoint, q, limits);
            let towards = || waypoint.iter().zip(q).map(|(to, from)| to - from);
            if left_s > NONE_S {
                // From rest: not before the joints may turn back.
                if self.share > 0.0 || calm.allows(towards()) {
                    let target = slowing(left_s, rise_s).min(most).min(stopping(left_s, stop_s, dt));
                    self.share = target.clamp((self.share - dt / stop_s).max(0.0), self.share + dt / rise_s);
                    // The last step ends at the waypoint, not beyond.
                    let rate = (self.share / left_s).min(1.0 / dt);
                    out.iter_mut().zip(towards()).for_each(|(v, d)| *v = d * rate);
                }
                return;
            }
            self.waypoints.pop();
            self.share = 0.0;
        }
    }
}

/// Share of the speed from which, after this tick, a stop ends no farther: `v·dt + v²/(2a) = left`.
fn stopping(left_s: f64, stop_s: f64, dt: f64) -> f64 {
    2.0 * left_s / (dt + (dt * dt + 2.0 * left_s * stop_s).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn after_braking_it_goes_on_from_the_speed_that_is_left() {
        let limits = [JointLimit { lower: -9.0, upper: 9.0, speed: 2.0, acceleration: 8.0, stop: 20.0 }; 2];
        let (calm, dt) = (Calm::new(2, 0.25), 0.004);
        let mut way = Way::new(vec![vec![0.0, 0.0], vec![1.0, -0.5], vec![1.5, 0.5]]);
        let (mut q, mut qd) = ([0.0, 0.0], [0.0, 0.0]);
        let mut next = [0.0, 0.0];
        let mut ticks = 0;
        while !way.is_empty() {
            way.follow(dt, 0.5, &Moving { q: &q, qd: &qd, limits: &limits }, &calm, &mut next);
            // Somebody brakes now and then.
            if (20..24).contains(&(ticks % 50)) {
                crate::joint::brake(&limits, &[[-9.0, 9.0]; 2], &qd, dt, &mut next);
            }
            for j in 0..2 {
                let rate = (next[j] - qd[j]) / dt;
                assert!(rate.abs() <= 20.0 * (1.0 + 1e-9), "tick {ticks}: {rate}");
                assert!(next[j].abs() <= 1.0 + 1e-9);
                let faster = (next[j].abs() - qd[j].abs()) / dt;
                assert!(faster <= 8.0 * (1.0 + 1e-9), "tick {ticks}: {faster}");
                q[j] += next[j] * dt;
            }
            qd = next;
            ticks += 1;
            assert!(ticks < 5_000);
        }
        assert!((q[0] - 1.5).abs() < 1e-6 && (q[1] - 0.5).abs() < 1e-6, "{q:?}");
    }
}
