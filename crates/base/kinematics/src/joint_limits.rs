//! Limits of the motion of a joint.

use crate::Chain;

/// Limits of the motion of a joint, in rad or m, per s, s² and s³: of planned paths, of programs, of avoidance.
///
/// Rates are always known; in a [model](crate::Limits) they may be missing.
///
/// ```
/// use elbowroom_kinematics::JointLimits;
/// let limits = JointLimits::new(2.0, 8.0, 80.0).within(-1.5, 1.5).stopping_at(20.0);
/// assert_eq!(limits.slowed_to(0.25).velocity, 0.5);
/// assert_eq!(JointLimits::new(2.0, 8.0, 80.0).stop, 8.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimits {
    /// Smallest position; −∞ if unlimited.
    pub lower: f64,
    /// Largest position; +∞ if unlimited.
    pub upper: f64,
    /// Largest speed.
    pub velocity: f64,
    /// Largest acceleration of a planned or programmed move.
    pub acceleration: f64,
    /// Largest jerk of a planned or programmed move.
    pub jerk: f64,
    /// Deceleration of a stop.
    pub stop: f64,
}

impl JointLimits {
    /// Limits of a joint that stops with its acceleration, at any position.
    pub const fn new(velocity: f64, acceleration: f64, jerk: f64) -> Self {
        let (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY);
        Self { lower, upper, velocity, acceleration, jerk, stop: acceleration }
    }

    /// The same limits with a range of positions.
    #[must_use]
    pub const fn within(self, lower: f64, upper: f64) -> Self {
        Self { lower, upper, ..self }
    }

    /// The same limits with another deceleration of a stop.
    #[must_use]
    pub const fn stopping_at(self, stop: f64) -> Self {
        Self { stop, ..self }
    }

    /// The same limits with a fraction of the speed.
    #[must_use]
    pub const fn slowed_to(self, fraction: f64) -> Self {
        Self { velocity: self.velocity * fraction, ..self }
    }

    /// Limits of the independent joints of a chain, with unlimited jerk. Full speed is reached in `rise_s` (s) and stopped in
    /// at most `stop_s` (s); joints without a rated speed get `fallback_speed` (rad/s or m/s).
    pub fn of_chain(chain: &Chain, rise_s: f64, stop_s: f64, fallback_speed: f64) -> Vec<Self> {
        let joints = chain.active_joints().iter().map(|id| &chain.joints()[id.0].limits);
        let limits = joints.map(|l| {
            let speed = l.velocity.filter(|v| v.is_finite() && *v > 0.0).unwrap_or(fallback_speed);
            let rates = Self::new(speed, speed / rise_s, f64::INFINITY).stopping_at(speed / stop_s.min(rise_s));
            rates.within(l.lower, l.upper)
        });
        limits.collect()
    }
}
