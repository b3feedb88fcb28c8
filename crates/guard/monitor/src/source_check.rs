//! Plausibility check of the sources of motion that regions follow.

use crate::{SourceSpec, SourceState};

/// Plausibility of a source's last reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum SourceStatus {
    /// The reading is current, finite and within the limits.
    Valid,
    /// The reading is stale, from the future, or not finite.
    Lost,
    /// The reading is farther from the last valid one than the limits or the reported motion allow.
    Jumped,
}

/// Checks each source against its last valid reading.
#[derive(Debug)]
pub(crate) struct SourceCheck {
    last_valid: Vec<Option<SourceState>>,
    status: Vec<SourceStatus>,
}

impl SourceCheck {
    pub(crate) fn new(sources: usize) -> Self {
        Self { last_valid: vec![None; sources], status: vec![SourceStatus::Valid; sources] }
    }

    /// Checks the readings of one tick. Only valid readings are stored. The allowed travel grows with the time since the
    /// last valid reading, so a source that was moved by hand becomes valid again.
    pub(crate) fn update(&mut self, specs: &[SourceSpec], sources: &[SourceState], now_s: f64, stale_s: f64) {
        for (i, (spec, source)) in specs.iter().zip(sources).enumerate() {
            let is_current = (0.0..=stale_s).contains(&(now_s - source.stamp_s));
            let is_plausible = || match &self.last_valid[i] {
                Some(last) => spec.limits.allow(last, source),
                None => spec.limits.allow_motion(source),
            };
            self.status[i] = if !(is_current && source.pose.is_finite() && source.motion.is_finite()) {
                SourceStatus::Lost
            } else if is_plausible() {
                SourceStatus::Valid
            } else {
                SourceStatus::Jumped
            };
            if self.status[i] == SourceStatus::Valid {
                self.last_valid[i] = Some(*source);
            }
        }
    }

    /// Status of a source in the last update.
    pub(crate) fn status(&self, source: usize) -> SourceStatus {
        self.status[source]
    }
}

#[cfg(test)]
mod tests {
    use elbowroom_spatial::{FrameMotion, Pose, Rotation, Vec3};

    use super::*;
    use crate::SourceLimits;

    fn at(stamp_s: f64, x: f64, speed: f64) -> SourceState {
        let motion = FrameMotion { velocity: Vec3::X * speed, ..FrameMotion::REST };
        SourceState { pose: Pose::from_translation(Vec3::X * x), motion, stamp_s }
    }

    fn statuses(limits: SourceLimits, readings: &[SourceState]) -> Vec<SourceStatus> {
        let specs = [SourceSpec { limits, ..SourceSpec::from("belt") }];
        let mut check = SourceCheck::new(1);
        let update = |s: &SourceState| {
            check.update(&specs, &[*s], s.stamp_s, 0.02);
            check.status(0)
        };
        readings.iter().map(update).collect()
    }

    #[test]
    fn a_jump_is_a_fault_until_the_limits_allow_the_travel() {
        let readings: Vec<_> = (0..60).map(|i| at(f64::from(i) * 0.01, if i < 5 { 0.0 } else { 3.9 }, 0.0)).collect();
        let statuses = statuses(SourceLimits::default(), &readings);
        // The last valid reading is the one at 0.04 s; 3.9 m take 0.39 s at 10 m/s.
        let jumped = statuses.iter().filter(|t| **t == SourceStatus::Jumped).count();
        assert_eq!((statuses[4], statuses[5], jumped), (SourceStatus::Valid, SourceStatus::Jumped, 38));
        assert_eq!(statuses[59], SourceStatus::Valid);
    }

    #[test]
    fn motion_that_is_not_reported_is_a_jump() {
        let moving = |reported: f64| [at(0.0, 0.0, reported), at(0.01, 0.03, reported)];
        assert_eq!(statuses(SourceLimits::default(), &moving(3.0))[1], SourceStatus::Valid);
        assert_eq!(statuses(SourceLimits::default(), &moving(0.0))[1], SourceStatus::Jumped);
        let slow = SourceLimits { speed_m_s: 1.0, ..SourceLimits::default() };
        assert_eq!(statuses(slow, &moving(3.0)), [SourceStatus::Jumped, SourceStatus::Jumped]);
    }

    #[test]
    fn a_belt_may_wrap_around() {
        let readings = [at(0.0, 0.999, 1.0), at(0.002, 0.001, 1.0)];
        assert_eq!(statuses(SourceLimits::default(), &readings)[1], SourceStatus::Jumped);
        let wrapping = SourceLimits { wrap_m: Some(Vec3::X), ..SourceLimits::default() };
        assert_eq!(statuses(wrapping, &readings)[1], SourceStatus::Valid);
    }

    #[test]
    fn rotation_is_checked() {
        let turned = |rad: f64, rate: f64| SourceState {
            pose: Pose::new(Rotation::from_rotation_vector(Vec3::Z * rad), Vec3::ZERO),
            motion: FrameMotion { angular_velocity: Vec3::Z * rate, ..FrameMotion::REST },
            stamp_s: 0.01,
        };
        let last = |s| statuses(SourceLimits::default(), &[at(0.0, 0.0, 0.0), s])[1];
        assert_eq!(last(turned(0.1, 10.0)), SourceStatus::Valid);
        assert_eq!(last(turned(0.1, 0.0)), SourceStatus::Jumped);
        assert_eq!(last(turned(0.3, 15.0)), SourceStatus::Jumped);
    }
}
