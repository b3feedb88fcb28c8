//! Sources of motion that regions follow, and the limits of their plausible motion.

use elbowroom_spatial::{Pose, Vec3};

use crate::SourceState;

/// Noise of a pose (m, rad) that does not count as motion.
const JITTER: f64 = 2e-3;
/// Fraction by which a pose may move faster than the reported motion.
const UNREPORTED_FRACTION: f64 = 0.1;
/// Speed (m/s, rad/s) by which a pose may move faster than the reported motion, in addition.
const UNREPORTED_SPEED: f64 = 0.5;
/// Time between two readings (s) above which the reported motion is not used to check them.
const REPORT_VALID_S: f64 = 0.1;

/// A source of motion and its plausibility limits.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceSpec {
    /// Name for reports.
    pub name: String,
    /// Limits of its motion; motion beyond them is a fault.
    pub limits: SourceLimits,
}

impl From<String> for SourceSpec {
    /// A source with the default limits.
    fn from(name: String) -> Self {
        Self { name, limits: SourceLimits::default() }
    }
}

impl From<&str> for SourceSpec {
    /// A source with the default limits.
    fn from(name: &str) -> Self {
        name.to_owned().into()
    }
}

/// The fastest motion of a source that counts as plausible.
///
/// ```
/// use elbowroom_monitor::SourceLimits;
/// let belt = SourceLimits { speed_m_s: 2.0, ..SourceLimits::default() };
/// assert_eq!(belt.turn_rad_s, 20.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SourceLimits {
    /// Largest speed of its origin, m/s. By default 10: faster than conveyors, vehicles and most robots.
    pub speed_m_s: f64,
    /// Largest turning rate, rad/s. By default 20: about three turns per second.
    pub turn_rad_s: f64,
    /// Travel (m, in the world) after which the reading wraps around, as for an encoder. A step back by this travel is
    /// not a jump.
    pub wrap_m: Option<Vec3>,
}

impl Default for SourceLimits {
    fn default() -> Self {
        Self { speed_m_s: 10.0, turn_rad_s: 20.0, wrap_m: None }
    }
}

impl SourceLimits {
    /// Why the limits are invalid, if they are.
    pub(crate) fn problem(&self) -> Option<String> {
        let positive = |v: f64| v.is_finite() && v > 0.0;
        if !positive(self.speed_m_s) {
            return Some(format!("its largest speed must be positive, not {} m/s", self.speed_m_s));
        }
        if !positive(self.turn_rad_s) {
            return Some(format!("its largest turning rate must be positive, not {} rad/s", self.turn_rad_s));
        }
        let wrap = self.wrap_m.filter(|w| !w.is_finite());
        wrap.map(|_| "the travel after which it begins again is not finite".into())
    }

    /// True if the motion from one reading to the next is plausible.
    pub(crate) fn allow(&self, from: &SourceState, to: &SourceState) -> bool {
        let elapsed_s = to.stamp_s - from.stamp_s;
        if elapsed_s < 0.0 || !self.allow_motion(to) {
            return false;
        }
        let moved = self.moved(&from.pose, &to.pose);
        let turned = (from.pose.rotation.inverse() * to.pose.rotation).angle();
        let possible = moved <= self.speed_m_s * elapsed_s + JITTER && turned <= self.turn_rad_s * elapsed_s + JITTER;
        if elapsed_s > REPORT_VALID_S {
            return possible;
        }
        // The laws extrapolate with the reported motion, so the pose must match it.
        let reported =
            |a: f64, b: f64| (a.max(b) * (1.0 + UNREPORTED_FRACTION) + UNREPORTED_SPEED) * elapsed_s + JITTER;
        let (a, b) = (&from.motion, &to.motion);
        possible
            && moved <= reported(a.velocity.length(), b.velocity.length())
            && turned <= reported(a.angular_velocity.length(), b.angular_velocity.length())
    }

    /// True if the reported velocities are within the limits.
    pub(crate) fn allow_motion(&self, s: &SourceState) -> bool {
        s.motion.velocity.length() <= self.speed_m_s && s.motion.angular_velocity.length() <= self.turn_rad_s
    }

    /// Distance (m) between the origins, across the wrap if there is one.
    fn moved(&self, from: &Pose, to: &Pose) -> f64 {
        let step = to.translation - from.translation;
        let wrapped = self.wrap_m.map_or(f64::INFINITY, |w| (step + w).length().min((step - w).length()));
        step.length().min(wrapped)
    }
}
