//! Entry into a new trajectory without a stop.
//!
//! A trajectory starts at rest. A trajectory that replaces another one in motion therefore starts on the current
//! straight segment *behind* the arm, so far back that it is at least as fast as the arm when it passes the arm's
//! configuration. It leaves the segment so far ahead that the arm could stop before. Execution enters the trajectory at
//! the arm's configuration, at the rate at which the two speeds are equal: position, direction and speed are
//! continuous.

use elbowroom_kinematics::JointLimits;

/// Reserve of the distance in which a speed is reached: a factor, and a length in rad for speeds near 0.
const DISTANCE_RESERVE_FACTOR: f64 = 1.05;
const DISTANCE_RESERVE_RAD: f64 = 1e-3;
/// Smallest component of a direction that counts: joints that do not move along the direction do not limit the motion.
const MIN_COMPONENT: f64 = 1e-12;
/// Step of the search for a root, seconds: an arm hardly changes its speed in one step.
const ROOT_STEP_S: f64 = 0.004;
/// Number of bisections of such a step: down to rounding.
const ROOT_BISECTIONS: usize = 50;

/// Distance (rad) in which a speed (rad/s) along a direction of unit length is reached from rest, with a reserve. It is
/// also the distance to stop from that speed.
///
/// ```
/// use elbowroom_perception::motion_entry::acceleration_distance;
/// use elbowroom_kinematics::JointLimits;
/// let limits = [JointLimits::new(2.0, 4.0, 1e6)];
/// // v²/2a = 0.125 rad, and five percent.
/// assert!((acceleration_distance(1.0, &[1.0], &limits) - 0.132).abs() < 1e-3);
/// ```
pub fn acceleration_distance(speed: f64, along: &[f64], limits: &[JointLimits]) -> f64 {
    let least = |of: fn(&JointLimits) -> f64| {
        let each = limits.iter().map(of).zip(along).map(|(most, part)| most / part.abs().max(MIN_COMPONENT));
        each.fold(f64::INFINITY, f64::min)
    };
    let (a, j) = (least(|l| l.acceleration), least(|l| l.jerk));
    let seconds = if speed >= a * a / j { speed / a + a / j } else { 2.0 * (speed / j).sqrt() };
    0.5 * speed * seconds * DISTANCE_RESERVE_FACTOR + DISTANCE_RESERVE_RAD
}

/// First zero (s), up to `end` (s), of a function of time that rises from below 0: found by steps, then bisection.
pub fn first_root(value: impl Fn(f64) -> f64, end: f64) -> Option<f64> {
    let mut low = 0.0;
    let mut high = low;
    while value(high) < 0.0 {
        low = high;
        high += ROOT_STEP_S;
        if low > end {
            return None;
        }
    }
    for _ in 0..ROOT_BISECTIONS {
        let middle = f64::midpoint(low, high);
        if value(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(high)
}
