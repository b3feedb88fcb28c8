//! What the joints may do, as bounds of the next velocity.

use elbowroom_kinematics::Chain;

use crate::VelocityBounds;

/// One joint's limits: rad, or m where it slides, per s and s².
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimit {
    /// Lowest value; −∞ where there is none.
    pub lower: f64,
    /// Highest value; +∞ where there is none.
    pub upper: f64,
    /// Top speed.
    pub speed: f64,
    /// Acceleration.
    pub acceleration: f64,
    /// Deceleration of a stop, at least the acceleration.
    pub stop: f64,
}

impl JointLimit {
    /// The limits of a chain's independent joints, with dynamics for all: full speed is reached in `rise_s` seconds and
    /// stopped in `stop_s`; joints without a speed go at most so fast (rad/s or m/s).
    pub fn of(chain: &Chain, rise_s: f64, stop_s: f64, fallback_speed: f64) -> Vec<Self> {
        let joints = chain.active_joints().iter().map(|id| &chain.joints()[id.0].limits);
        joints
            .map(|l| {
                let speed = l.velocity.filter(|v| v.is_finite() && *v > 0.0).unwrap_or(fallback_speed);
                Self {
                    lower: l.lower,
                    upper: l.upper,
                    speed,
                    acceleration: speed / rise_s,
                    stop: speed / stop_s.min(rise_s),
                }
            })
            .collect()
    }

    /// What is wrong with it, and what to write instead.
    pub(crate) fn wrong(&self) -> Option<&'static str> {
        let rate = |v: f64| v > 0.0 && v.is_finite();
        if !rate(self.speed) {
            return Some("the speed is not above 0: give its top speed, rad/s or m/s");
        }
        if !rate(self.acceleration) {
            return Some("the acceleration is not above 0: give rad/s² or m/s²");
        }
        if !(self.stop >= self.acceleration && self.stop.is_finite()) {
            return Some("the deceleration of a stop is less than the acceleration: give at least that");
        }
        let bounds = self.lower <= self.upper && self.lower < f64::INFINITY && self.upper > f64::NEG_INFINITY;
        (!bounds).then_some("lower and upper are no range: give lower <= upper, -inf and inf where there is none")
    }

    /// Velocities after which the joint can still stop before its limits, `dt` seconds being the command's length.
    fn soon(&self, q: f64, dt: f64) -> [f64; 2] {
        // v·dt + v²/(2a) = room
        let fastest = |room: f64| {
            if room.is_infinite() {
                return self.speed;
            }
            let a = self.stop;
            (a * ((dt * dt + 2.0 * room.max(0.0) / a).sqrt() - dt)).min(self.speed)
        };
        [-fastest(q - self.lower), fastest(self.upper - q)]
    }

    /// The greatest velocity after one tick: to rest as fast as a stop, from there as fast as the joint accelerates.
    fn faster(&self, qd: f64, dt: f64) -> f64 {
        let stopping_s = (-qd).max(0.0) / self.stop;
        if stopping_s >= dt { qd + self.stop * dt } else { qd.max(0.0) + self.acceleration * (dt - stopping_s) }
    }

    /// The same for the next command, from the velocity `qd`.
    fn now(&self, [low, high]: [f64; 2], qd: f64, dt: f64) -> [f64; 2] {
        let upper = self.faster(qd, dt);
        let lower = -self.faster(-qd, dt);
        // A limit of the joint goes before one of its acceleration.
        [lower.clamp(low, high), upper.clamp(low, high)]
    }
}

/// Fills the bounds for joints at `q` with velocities `qd`.
pub fn fill(bounds: &mut VelocityBounds, limits: &[JointLimit], q: &[f64], qd: &[f64], dt: f64) {
    for (j, limit) in limits.iter().enumerate() {
        bounds.soon[j] = limit.soon(q[j], dt);
        bounds.now[j] = limit.now(bounds.soon[j], qd[j], dt);
    }
}

/// Seconds that a stop takes from these velocities.
pub fn stop_s(limits: &[JointLimit], qd: &[f64]) -> f64 {
    qd.iter().zip(limits).map(|(v, l)| v.abs() / l.stop).fold(0.0, f64::max)
}

/// Slower by as much as a stop allows, all joints in proportion: straight on, where it was proven to be free. A joint that
/// would so pass its limit (`soon`, the velocities from which it can still stop) stops by itself.
pub fn brake(limits: &[JointLimit], soon: &[[f64; 2]], qd: &[f64], dt: f64, out: &mut [f64]) {
    let stop_s = stop_s(limits, qd);
    let left = if stop_s > dt { 1.0 - dt / stop_s } else { 0.0 };
    for ((out, v), [low, high]) in out.iter_mut().zip(qd).zip(soon) {
        *out = (v * left).clamp(low.min(0.0), high.max(0.0));
    }
}

/// The fastest of these velocities as a share of its joint's top speed.
pub fn share(qd: &[f64], limits: &[JointLimit]) -> f64 {
    qd.iter().zip(limits).map(|(v, l)| v.abs() / l.speed).fold(0.0, f64::max)
}

/// Seconds of joint motion at full speed between two configurations.
pub fn astray(to: &[f64], from: &[f64], limits: &[JointLimit]) -> f64 {
    to.iter().zip(from).zip(limits).map(|((a, b), l)| (a - b).abs() / l.speed).fold(0.0, f64::max)
}

/// How much of the wanted velocity a velocity has in its direction, in the norm of the joints' speeds; 1 where nothing is
/// wanted.
pub fn headway(velocity: &[f64], wanted: &[f64], limits: &[JointLimit]) -> f64 {
    let along =
        |a: &[f64]| a.iter().zip(wanted).zip(limits).map(|((a, w), l)| a * w / (l.speed * l.speed)).sum::<f64>();
    let whole = along(wanted);
    if whole > 0.0 { along(velocity) / whole } else { 1.0 }
}

/// Share of the speed from which the rest of the way is enough to stop.
pub fn slowing(left_s: f64, rise_s: f64) -> f64 {
    (1.6 * left_s / rise_s.max(1e-6)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_that_turns_back_stops_hard_and_accelerates_softly() {
        let limit = JointLimit { lower: -9.0, upper: 9.0, speed: 2.0, acceleration: 4.0, stop: 10.0 };
        let now = |qd: f64| limit.now([-2.0, 2.0], qd, 0.1);
        let near =
            |a: [f64; 2], b: [f64; 2]| assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12, "{a:?}");
        near(now(0.0), [-0.4, 0.4]);
        near(now(1.5), [0.5, 1.9]);
        // Half of the tick to rest, the other half away from it.
        near(now(0.5), [-0.2, 0.9]);
        near(now(-0.5), [-0.9, 0.2]);
    }
}
