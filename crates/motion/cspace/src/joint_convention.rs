//! Conversion between a manufacturer's joint values and those of the planar arm.

use std::f64::consts::FRAC_PI_2;

/// A manufacturer's convention for the three joints: planar value = `sign` · manufacturer's value + `offset_rad`, joint by
/// joint. Straight segments in one are straight in the other.
///
/// ```
/// use elbowroom_cspace::{JointConvention, PlanarArm};
/// // The KR125 at zero is stretched forward: the wrist is 2 m before the shoulder and 45 mm higher.
/// let q = JointConvention::KR125.to_planar([0.0; 3]);
/// let wrist = PlanarArm::KR125.joints_in_base(q)[2];
/// assert!((wrist.x - 2.41).abs() < 1e-9 && (wrist.z - 0.91).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointConvention {
    /// 1, or −1 where the joint has the opposite sense.
    pub sign: [f64; 3],
    /// The planar value at the manufacturer's zero, radians.
    pub offset_rad: [f64; 3],
}

impl JointConvention {
    /// The KUKA KR125: axis 1 has the opposite sense; axis 2 is 0 where the upper arm lies forward (planar: π/2); axis 3 is
    /// 0 where the forearm continues the upper arm. The line from elbow to wrist is atan(0.045) above the forearm.
    pub const KR125: Self = Self {
        sign: [-1.0, 1.0, 1.0],
        // −π/2 − atan(0.045)
        offset_rad: [0.0, FRAC_PI_2, -1.615_765_988_647_224],
    };

    /// From the manufacturer's values to planar ones, radians.
    pub fn to_planar(&self, q: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| self.sign[i] * q[i] + self.offset_rad[i])
    }

    /// From planar values to the manufacturer's, radians.
    pub fn from_planar(&self, q: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| (q[i] - self.offset_rad[i]) * self.sign[i])
    }

    /// A range of joint `i` (0, 1, 2) in planar values, radians: lower limit first.
    pub fn planar_range(&self, i: usize, [min, max]: [f64; 2]) -> [f64; 2] {
        let at = |value: f64| self.sign[i] * value + self.offset_rad[i];
        let (a, b) = (at(min), at(max));
        [a.min(b), a.max(b)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PlanarArm;

    #[test]
    fn constants_agree_with_their_formulas() {
        assert!((PlanarArm::KR125.fore_length_m - 1.0_f64.hypot(0.045)).abs() < 1e-9);
        assert!((JointConvention::KR125.offset_rad[2] + FRAC_PI_2 + 0.045_f64.atan()).abs() < 1e-9);
    }

    #[test]
    fn conversions_are_inverse_to_each_other() {
        let q = [0.3, -1.2, 0.7];
        let back = JointConvention::KR125.from_planar(JointConvention::KR125.to_planar(q));
        assert!((0..3).all(|i| (back[i] - q[i]).abs() < 1e-12));
        let [min, max] = JointConvention::KR125.planar_range(0, [-1.0, 2.0]);
        assert_eq!([min, max], [-2.0, 1.0]);
    }
}
