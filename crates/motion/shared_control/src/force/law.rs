//! The repulsion of two bodies as a function of their distance.

use crate::NavigatorError;

/// Share of the range below which Khatib's force, which is infinite on contact, stays what it is there.
const CAP: f64 = 0.125;
/// Share of the range over which the damper begins.
const DAMPER_RAMP: f64 = 0.25;

/// How the force grows as two bodies come nearer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ForceProfile {
    /// `k (r − d)`: a spring (Reichenbach and Kovačić, 2003).
    Linear,
    /// `η (1/d − 1/r) / d²` with `η = k r⁴ / 8`, as strong as the spring at half of the range (Khatib, 1986). Below an
    /// eighth of the range it is constant.
    Khatib,
}

/// The repulsion of two bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceLaw {
    /// The shape of the force.
    pub field: ForceProfile,
    /// Distance at which it begins, metres.
    pub range_m: f64,
    /// Stiffness k, N/m.
    pub stiffness_n_m: f64,
    /// Damping of the approach, N·s/m; it never holds back what moves away.
    pub damping_n_s_m: f64,
    /// How the range grows with the speed of the approach; `None` if it does not.
    pub aureole: Option<Aureole>,
}

/// A range that grows with the speed of approach by the way of reaction and braking.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aureole {
    /// Time of reaction, s.
    pub reaction_s: f64,
    /// Deceleration, m/s².
    pub deceleration_m_s2: f64,
}

impl ForceLaw {
    /// A spring without damping.
    pub fn spring(range_m: f64, stiffness_n_m: f64) -> Self {
        Self { field: ForceProfile::Linear, range_m, stiffness_n_m, damping_n_s_m: 0.0, aureole: None }
    }

    /// Checks the constants.
    ///
    /// # Errors
    /// A range, stiffness or deceleration that is not a positive number, or a negative damping or time.
    pub fn check(&self) -> Result<(), NavigatorError> {
        let aureole = self.aureole.unwrap_or(Aureole { reaction_s: 0.0, deceleration_m_s2: 1.0 });
        let positive = [
            ("range_m", self.range_m),
            ("stiffness_n_m", self.stiffness_n_m),
            ("deceleration_m_s2", aureole.deceleration_m_s2),
        ];
        NavigatorError::check_positive(&positive)?;
        NavigatorError::check_not_negative(&[("damping_n_s_m", self.damping_n_s_m), ("reaction_s", aureole.reaction_s)])
    }

    /// Range at this speed of approach (m/s), metres.
    pub fn range_at(&self, approach_m_s: f64) -> f64 {
        let v = approach_m_s.max(0.0);
        self.range_m + self.aureole.map_or(0.0, |a| v * a.reaction_s + v * v / (2.0 * a.deceleration_m_s2))
    }

    /// Energy stored at a distance (m), J, with a range of `range_m`.
    pub fn potential_j(&self, distance_m: f64, range_m: f64) -> f64 {
        if !(distance_m < range_m) {
            return 0.0;
        }
        let k = self.stiffness_n_m;
        match self.field {
            ForceProfile::Linear => 0.5 * k * (range_m - distance_m).powi(2),
            ForceProfile::Khatib => {
                let least = CAP * range_m;
                let d = distance_m.max(least);
                let eta = 0.125 * k * range_m.powi(4);
                let below = (least - distance_m).max(0.0) * self.force_n(least, range_m);
                0.5 * eta * (1.0 / d - 1.0 / range_m).powi(2) + below
            }
        }
    }

    /// Force of the field at a distance (m), N: the slope of [`Self::potential_j`].
    pub fn force_n(&self, distance_m: f64, range_m: f64) -> f64 {
        if !(distance_m < range_m) {
            return 0.0;
        }
        let k = self.stiffness_n_m;
        match self.field {
            ForceProfile::Linear => k * (range_m - distance_m),
            ForceProfile::Khatib => {
                let d = distance_m.max(CAP * range_m);
                0.125 * k * range_m.powi(4) * (1.0 / d - 1.0 / range_m) / (d * d)
            }
        }
    }

    /// Slope of the force, N/m, for the implicit step.
    pub(crate) fn slope_n_m(&self, distance_m: f64, range_m: f64) -> f64 {
        if !(distance_m < range_m) {
            return 0.0;
        }
        match self.field {
            ForceProfile::Linear => self.stiffness_n_m,
            ForceProfile::Khatib if distance_m <= CAP * range_m => 0.0,
            ForceProfile::Khatib => {
                let (d, eta) = (distance_m, 0.125 * self.stiffness_n_m * range_m.powi(4));
                eta * (3.0 / d - 2.0 / range_m) / d.powi(3)
            }
        }
    }

    /// Damping at a distance (m), N·s/m. It begins without a jump.
    pub(crate) fn damping_at(&self, distance_m: f64, range_m: f64) -> f64 {
        let share = (range_m - distance_m) / (DAMPER_RAMP * range_m);
        self.damping_n_s_m * share.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_slopes_of_their_potentials() {
        for field in [ForceProfile::Linear, ForceProfile::Khatib] {
            let law = ForceLaw { field, ..ForceLaw::spring(0.04, 2000.0) };
            for k in 0..=400 {
                let (d, h) = (1e-4 * f64::from(k) + 3e-5, 1e-7);
                let slope = (law.potential_j(d - h, 0.04) - law.potential_j(d + h, 0.04)) / (2.0 * h);
                let force = law.force_n(d, 0.04);
                assert!((slope - force).abs() <= 1e-5 * force.max(1.0), "{field:?} at {d}: {slope}, {force}");
                let slope = (law.force_n(d - h, 0.04) - law.force_n(d + h, 0.04)) / (2.0 * h);
                let expected = law.slope_n_m(d, 0.04);
                assert!((slope - expected).abs() <= 1e-3 * expected.max(1.0), "{field:?} at {d}: {slope}, {expected}");
            }
        }
    }

    #[test]
    fn both_fields_are_equal_at_half_of_the_range_and_nothing_beyond() {
        let spring = ForceLaw::spring(0.04, 2000.0);
        let khatib = ForceLaw { field: ForceProfile::Khatib, ..spring };
        assert!((spring.force_n(0.02, 0.04) - khatib.force_n(0.02, 0.04)).abs() < 1e-9);
        for law in [spring, khatib] {
            assert_eq!((law.force_n(0.04, 0.04), law.potential_j(0.05, 0.04)), (0.0, 0.0));
            assert_eq!(law.force_n(f64::NAN, 0.04), 0.0);
            assert!(law.force_n(0.0, 0.04).is_finite());
        }
    }

    #[test]
    fn an_aureole_adds_reaction_and_braking_for_approaches_alone() {
        let aureole = Some(Aureole { reaction_s: 0.1, deceleration_m_s2: 2.0 });
        let law = ForceLaw { aureole, ..ForceLaw::spring(0.02, 100.0) };
        assert!((law.range_at(0.4) - (0.02 + 0.04 + 0.04)).abs() < 1e-15);
        assert_eq!(law.range_at(-3.0), 0.02);
    }
}
