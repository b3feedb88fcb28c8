//! A planned way that is gone along.

use crate::calm::Calm;
use crate::joint::{JointLimit, astray, slowing};

/// A deviation of so many seconds at full joint speed is none.
pub const NONE_S: f64 = 1e-9;

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
    pub fn follow(&mut self, dt: f64, most: f64, q: &[f64], limits: &[JointLimit], calm: &Calm, out: &mut [f64]) {
        let slowest = |f: fn(&JointLimit) -> f64| limits.iter().map(f).fold(0.0, f64::max);
        let (rise_s, stop_s) = (slowest(|l| l.speed / l.acceleration), slowest(|l| l.speed / l.stop));
        out.fill(0.0);
        while let Some(waypoint) = self.waypoints.last() {
            let left_s = astray(waypoint, q, limits);
            let towards = || waypoint.iter().zip(q).map(|(to, from)| to - from);
            if left_s > NONE_S {
                // From rest: not before the joints may turn back.
                if self.share > 0.0 || calm.allows(towards()) {
                    let target = slowing(left_s, rise_s).min(most).min(left_s / dt);
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
