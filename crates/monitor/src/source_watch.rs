//! Does what carries a region move as such a thing can? (P.6)

use elbowroom_spatial::{Pose, Vec3};

use crate::Source;

/// Noise of a pose (m, rad) that is no motion.
const JITTER: f64 = 2e-3;
/// A pose may run ahead of the motion that is stated with it by this share of it, and by this speed (m/s, rad/s).
const UNSTATED_SHARE: f64 = 0.1;
const UNSTATED_SPEED: f64 = 0.5;
/// For longer than this (s) two stated motions say nothing about what happened in between.
const STATED_FOR_S: f64 = 0.1;

/// A source of motion by name, and what it can do.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceSpec {
    /// Said in reports.
    pub name: String,
    /// What is a jump and no motion.
    pub limits: SourceLimits,
}

impl From<String> for SourceSpec {
    /// With the limits that suit most.
    fn from(name: String) -> Self {
        Self { name, limits: SourceLimits::default() }
    }
}

impl From<&str> for SourceSpec {
    /// With the limits that suit most.
    fn from(name: &str) -> Self {
        name.to_owned().into()
    }
}

/// The fastest motion of a source that is believed.
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
    /// The travel (m, in the world) after which it begins again, as encoders do: a step back by it is no jump.
    pub wrap_m: Option<Vec3>,
}

impl Default for SourceLimits {
    fn default() -> Self {
        Self { speed_m_s: 10.0, turn_rad_s: 20.0, wrap_m: None }
    }
}

impl SourceLimits {
    /// Why they cannot be used, where they cannot.
    pub(crate) fn fault(&self) -> Option<String> {
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

    /// True where the source can have gone from one reading to the next.
    fn allow(&self, from: &Source, to: &Source) -> bool {
        let elapsed_s = to.stamp_s - from.stamp_s;
        if elapsed_s < 0.0 || !self.allow_motion(to) {
            return false;
        }
        let moved = self.moved(&from.pose, &to.pose);
        let turned = (from.pose.rotation.inverse() * to.pose.rotation).angle();
        let possible = moved <= self.speed_m_s * elapsed_s + JITTER && turned <= self.turn_rad_s * elapsed_s + JITTER;
        if elapsed_s > STATED_FOR_S {
            return possible;
        }
        // The laws rely on the motion that is stated: what moves farther than that is not where they think it will be.
        let stated = |a: f64, b: f64| (a.max(b) * (1.0 + UNSTATED_SHARE) + UNSTATED_SPEED) * elapsed_s + JITTER;
        let (a, b) = (&from.motion, &to.motion);
        possible
            && moved <= stated(a.velocity.length(), b.velocity.length())
            && turned <= stated(a.angular_velocity.length(), b.angular_velocity.length())
    }

    /// True where the motion that is stated is not faster than the source can be.
    fn allow_motion(&self, s: &Source) -> bool {
        s.motion.velocity.length() <= self.speed_m_s && s.motion.angular_velocity.length() <= self.turn_rad_s
    }

    /// How far (m) the origin went.
    fn moved(&self, from: &Pose, to: &Pose) -> f64 {
        let step = to.translation - from.translation;
        let wrapped = self.wrap_m.map_or(f64::INFINITY, |w| (step + w).length().min((step - w).length()));
        step.length().min(wrapped)
    }
}

/// What is thought of a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Trust {
    /// It is where it says.
    Believed,
    /// Stale, from the future, or no finite number.
    Lost,
    /// Farther away than it can be by now, or than the motion that it states explains.
    Jumped,
}

/// Remembers the last reading of each source that was believed.
#[derive(Debug)]
pub(crate) struct SourceWatch {
    last: Vec<Option<Source>>,
    trust: Vec<Trust>,
}

impl SourceWatch {
    pub(crate) fn new(sources: usize) -> Self {
        Self { last: vec![None; sources], trust: vec![Trust::Believed; sources] }
    }

    /// Looks at the readings of one tick. What is not believed is not remembered: the longer that lasts, the farther the
    /// source may have gone meanwhile, so that one that was moved is believed again in time.
    pub(crate) fn look(&mut self, specs: &[SourceSpec], sources: &[Source], now_s: f64, stale_s: f64) {
        for (i, (spec, source)) in specs.iter().zip(sources).enumerate() {
            let fresh = (0.0..=stale_s).contains(&(now_s - source.stamp_s));
            let possible = || match &self.last[i] {
                Some(last) => spec.limits.allow(last, source),
                None => spec.limits.allow_motion(source),
            };
            self.trust[i] = if !(fresh && source.pose.is_finite() && source.motion.is_finite()) {
                Trust::Lost
            } else if possible() {
                Trust::Believed
            } else {
                Trust::Jumped
            };
            if self.trust[i] == Trust::Believed {
                self.last[i] = Some(*source);
            }
        }
    }

    /// What is thought of a source since the last look.
    pub(crate) fn trust(&self, source: usize) -> Trust {
        self.trust[source]
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::{Motion, Rotation};

    use super::*;

    fn at(stamp_s: f64, x: f64, speed: f64) -> Source {
        let motion = Motion { velocity: Vec3::X * speed, ..Motion::REST };
        Source { pose: Pose::from_translation(Vec3::X * x), motion, stamp_s }
    }

    fn trusts(limits: SourceLimits, readings: &[Source]) -> Vec<Trust> {
        let specs = [SourceSpec { limits, ..SourceSpec::from("belt") }];
        let mut watch = SourceWatch::new(1);
        let look = |s: &Source| {
            watch.look(&specs, &[*s], s.stamp_s, 0.02);
            watch.trust(0)
        };
        readings.iter().map(look).collect()
    }

    #[test]
    fn a_jump_is_not_believed_until_the_source_can_have_gone_there() {
        let readings: Vec<_> = (0..60).map(|i| at(f64::from(i) * 0.01, if i < 5 { 0.0 } else { 3.9 }, 0.0)).collect();
        let trusts = trusts(SourceLimits::default(), &readings);
        // The last believed reading is that of 0.04 s; 3.9 m take 0.39 s at 10 m/s.
        let jumped = trusts.iter().filter(|t| **t == Trust::Jumped).count();
        assert_eq!((trusts[4], trusts[5], jumped), (Trust::Believed, Trust::Jumped, 38));
        assert_eq!(trusts[59], Trust::Believed);
    }

    #[test]
    fn motion_that_is_not_stated_is_a_jump() {
        let moving = |stated: f64| [at(0.0, 0.0, stated), at(0.01, 0.03, stated)];
        assert_eq!(trusts(SourceLimits::default(), &moving(3.0))[1], Trust::Believed);
        assert_eq!(trusts(SourceLimits::default(), &moving(0.0))[1], Trust::Jumped);
        let slow = SourceLimits { speed_m_s: 1.0, ..SourceLimits::default() };
        assert_eq!(trusts(slow, &moving(3.0)), [Trust::Jumped, Trust::Jumped]);
    }

    #[test]
    fn a_belt_may_begin_again() {
        let readings = [at(0.0, 0.999, 1.0), at(0.002, 0.001, 1.0)];
        assert_eq!(trusts(SourceLimits::default(), &readings)[1], Trust::Jumped);
        let wrapping = SourceLimits { wrap_m: Some(Vec3::X), ..SourceLimits::default() };
        assert_eq!(trusts(wrapping, &readings)[1], Trust::Believed);
    }

    #[test]
    fn turning_counts() {
        let turned = |rad: f64, rate: f64| Source {
            pose: Pose::new(Rotation::from_rotation_vector(Vec3::Z * rad), Vec3::ZERO),
            motion: Motion { angular_velocity: Vec3::Z * rate, ..Motion::REST },
            stamp_s: 0.01,
        };
        let last = |s| trusts(SourceLimits::default(), &[at(0.0, 0.0, 0.0), s])[1];
        assert_eq!(last(turned(0.1, 10.0)), Trust::Believed);
        assert_eq!(last(turned(0.1, 0.0)), Trust::Jumped);
        assert_eq!(last(turned(0.3, 15.0)), Trust::Jumped);
    }
}
