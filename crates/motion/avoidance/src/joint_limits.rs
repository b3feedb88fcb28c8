//! Joint limits as bounds of the next velocity.

use std::fmt;

use elbowroom_kinematics::JointLimits;

use crate::VelocityBounds;

/// Square of the arrival speed per remaining time, both relative to a rise to full speed. With 2, at the deceleration
/// of a rise, the joint would just stop in time: the difference is a reserve.
const ARRIVAL_SQUARE: f64 = 1.6;
/// Smallest duration of a rise to full speed, s, so that the arrival speed stays finite.
const MIN_RISE_S: f64 = 1e-6;

/// Why the limits of a joint are invalid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LimitProblem {
    /// The top speed is not positive and finite.
    Speed,
    /// The acceleration is not positive and finite.
    Acceleration,
    /// The deceleration of a stop is below the acceleration, or not finite.
    Stop,
    /// The position limits are not a range.
    Range,
}

impl fmt::Display for LimitProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Speed => "the speed is not above 0: give its top speed, rad/s or m/s",
            Self::Acceleration => "the acceleration is not above 0: give rad/s² or m/s²",
            Self::Stop => "the deceleration of a stop is less than the acceleration: give at least that",
            Self::Range => "lower and upper are no range: give lower <= upper, -inf and inf where there is none",
        })
    }
}

/// Why the limits are invalid, if they are.
pub(crate) fn problem(limit: &JointLimits) -> Option<LimitProblem> {
    let is_rate = |v: f64| v > 0.0 && v.is_finite();
    if !is_rate(limit.velocity) {
        return Some(LimitProblem::Speed);
    }
    if !is_rate(limit.acceleration) {
        return Some(LimitProblem::Acceleration);
    }
    if !(limit.stop >= limit.acceleration && limit.stop.is_finite()) {
        return Some(LimitProblem::Stop);
    }
    let is_range = limit.lower <= limit.upper && limit.lower < f64::INFINITY && limit.upper > f64::NEG_INFINITY;
    (!is_range).then_some(LimitProblem::Range)
}

/// Velocities from which the joint can still stop before its limits; `dt` is the length of the command, s.
fn stoppable(limit: &JointLimits, q: f64, dt: f64) -> [f64; 2] {
    // v·dt + v²/(2a) = free
    let max_speed = |free: f64| {
        if free.is_infinite() {
            return limit.velocity;
        }
        let a = limit.stop;
        (a * ((dt * dt + 2.0 * free.max(0.0) / a).sqrt() - dt)).min(limit.velocity)
    };
    [-max_speed(q - limit.lower), max_speed(limit.upper - q)]
}

/// Largest velocity after one tick: slowing down to rest at the deceleration of a stop, then speeding up at the
/// acceleration.
fn max_next(limit: &JointLimits, qd: f64, dt: f64) -> f64 {
    let stopping_s = (-qd).max(0.0) / limit.stop;
    if stopping_s >= dt { qd + limit.stop * dt } else { qd.max(0.0) + limit.acceleration * (dt - stopping_s) }
}

/// Bounds of the next command from the velocity `qd`, within the stoppable velocities.
fn next(limit: &JointLimits, [low, high]: [f64; 2], qd: f64, dt: f64) -> [f64; 2] {
    let upper = max_next(limit, qd, dt);
    let lower = -max_next(limit, -qd, dt);
    // The position limits take precedence over the acceleration.
    [lower.clamp(low, high), upper.clamp(low, high)]
}

/// Updates the bounds for joints at `q` with velocities `qd`.
pub(crate) fn update_bounds(bounds: &mut VelocityBounds, limits: &[JointLimits], q: &[f64], qd: &[f64], dt: f64) {
    for (j, limit) in limits.iter().enumerate() {
        bounds.stoppable[j] = stoppable(limit, q[j], dt);
        bounds.next[j] = next(limit, bounds.stoppable[j], qd[j], dt);
    }
}

/// Duration of a stop from these velocities, s.
pub(crate) fn stop_s(limits: &[JointLimits], qd: &[f64]) -> f64 {
    qd.iter().zip(limits).map(|(v, l)| v.abs() / l.stop).fold(0.0, f64::max)
}

/// Brakes all joints in proportion at the deceleration of a stop, so that the robot stays on the straight line that was
/// checked. A joint that would pass its limit stops separately; `stoppable` are the velocities from which it can stop.
pub(crate) fn brake(limits: &[JointLimits], stoppable: &[[f64; 2]], qd: &[f64], dt: f64, out: &mut [f64]) {
    let stop_s = stop_s(limits, qd);
    let left = if stop_s > dt { 1.0 - dt / stop_s } else { 0.0 };
    for ((out, v), [low, high]) in out.iter_mut().zip(qd).zip(stoppable) {
        *out = (v * left).clamp(low.min(0.0), high.max(0.0));
    }
}

/// Largest velocity as a fraction of the joint's top speed.
pub(crate) fn speed_fraction(qd: &[f64], limits: &[JointLimits]) -> f64 {
    qd.iter().zip(limits).map(|(v, l)| v.abs() / l.velocity).fold(0.0, f64::max)
}

/// Distance of two configurations in seconds of joint motion at full speed.
pub(crate) fn distance_s(to: &[f64], from: &[f64], limits: &[JointLimits]) -> f64 {
    to.iter().zip(from).zip(limits).map(|((a, b), l)| (a - b).abs() / l.velocity).fold(0.0, f64::max)
}

/// Component of a velocity along the desired velocity, as a fraction of it, in the norm of the joints' speeds; 1 if the
/// desired velocity is 0.
pub(crate) fn progress(velocity: &[f64], desired: &[f64], limits: &[JointLimits]) -> f64 {
    let along =
        |a: &[f64]| a.iter().zip(desired).zip(limits).map(|((a, w), l)| a * w / (l.velocity * l.velocity)).sum::<f64>();
    let whole = along(desired);
    if whole > 0.0 { along(velocity) / whole } else { 1.0 }
}

/// Speed fraction from which the remaining distance is enough to stop.
pub(crate) fn arrival_speed(remaining_s: f64, rise_s: f64) -> f64 {
    (ARRIVAL_SQUARE * remaining_s / rise_s.max(MIN_RISE_S)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_that_reverses_stops_at_the_stop_rate_and_accelerates_at_the_acceleration() {
        let limit = JointLimits::new(2.0, 4.0, f64::INFINITY).within(-9.0, 9.0).stopping_at(10.0);
        let next = |qd: f64| next(&limit, [-2.0, 2.0], qd, 0.1);
        let near =
            |a: [f64; 2], b: [f64; 2]| assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12, "{a:?}");
        near(next(0.0), [-0.4, 0.4]);
        near(next(1.5), [0.5, 1.9]);
        // Half of the tick to rest, the other half speeding up again.
        near(next(0.5), [-0.2, 0.9]);
        near(next(-0.5), [-0.9, 0.2]);
    }
}
