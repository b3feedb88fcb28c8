//! Arithmetic on sixteen lanes of `f32`: inverse tangent and inverse cosine.
//!
//! Multiplications and additions are not fused, so that the result does not depend on the instruction set.

use elbowroom_validity::lanes::simd::{Select, Simd, SimdBase, SimdFloat, f32x16};

/// Sixteen numbers.
pub(crate) type Lanes<S> = f32x16<S>;

/// Number of lanes.
pub(super) const WIDTH: usize = 16;

#[inline(always)]
pub(super) fn splat<S: Simd>(simd: S, value: f32) -> Lanes<S> {
    Lanes::splat(simd, value)
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, from: &[f32]) -> Lanes<S> {
    Lanes::from_slice(simd, &from[..WIDTH])
}

/// `a·b + c`, rounded twice.
#[inline(always)]
pub(super) fn mad<S: Simd>(a: Lanes<S>, b: Lanes<S>, c: Lanes<S>) -> Lanes<S> {
    a * b + c
}

/// Horner's scheme; coefficients in ascending order of powers.
#[inline(always)]
fn polynomial<S: Simd>(simd: S, x: Lanes<S>, coefficients: &[f32]) -> Lanes<S> {
    let mut sum = splat(simd, coefficients[coefficients.len() - 1]);
    for &c in coefficients[..coefficients.len() - 1].iter().rev() {
        sum = mad(sum, x, splat(simd, c));
    }
    sum
}

/// atan(t)/t as a polynomial of t² on 0..1 (interpolated at Chebyshev nodes, error 4e-7).
#[allow(clippy::excessive_precision, clippy::unreadable_literal, reason = "as the fit gave them")]
const ATAN: [f32; 7] = [
    0.9999992255890977,
    -0.33325678039723927,
    0.19872040268214597,
    -0.13447864058090495,
    0.08312645300619582,
    -0.03636043085731773,
    0.007648353926762766,
];

/// acos(t)/√(1 − t) as a polynomial of t on 0..1 (interpolated at Chebyshev nodes, error 1.5e-6).
#[allow(clippy::excessive_precision, clippy::unreadable_literal, reason = "as the fit gave them")]
const ACOS: [f32; 6] = [
    1.5707948755676588,
    -0.21449625404349199,
    0.08774994875261322,
    -0.04460982332177288,
    0.0189549493550085,
    -0.004180968543343454,
];

/// Bound of the error of [`atan2`] and [`acos`], rounding included, radians: about ten times the measured error.
pub(crate) const ANGLE_ERROR: f32 = 1e-5;

/// Angle of the point (x, y), −π..π; 0 at the origin.
#[inline(always)]
pub(crate) fn atan2<S: Simd>(simd: S, y: Lanes<S>, x: Lanes<S>) -> Lanes<S> {
    let (ax, ay) = (x.abs(), y.abs());
    let steep = ay.simd_gt(ax);
    let ratio = ax.min(ay) / ax.max(ay).max(splat(simd, f32::MIN_POSITIVE));
    let shallow = ratio * polynomial(simd, ratio * ratio, &ATAN);
    let first = steep.select(splat(simd, std::f32::consts::FRAC_PI_2) - shallow, shallow);
    let half = x.simd_lt(splat(simd, 0.0)).select(splat(simd, std::f32::consts::PI) - first, first);
    half.copysign(y)
}

/// Angle of a cosine, 0..π; values beyond ±1 count as ±1.
#[inline(always)]
pub(super) fn acos<S: Simd>(simd: S, cosine: Lanes<S>) -> Lanes<S> {
    let t = cosine.abs().min(splat(simd, 1.0));
    let half = (splat(simd, 1.0) - t).sqrt() * polynomial(simd, t, &ACOS);
    cosine.simd_lt(splat(simd, 0.0)).select(splat(simd, std::f32::consts::PI) - half, half)
}

#[cfg(test)]
mod tests {
    use elbowroom_validity::lanes::simd::{Level as SimdLevel, dispatch, prelude::*};

    use super::*;

    #[test]
    fn angles_are_right_to_a_tenth_of_the_margin() {
        for i in 0..4000 {
            let angle = (f64::from(i) / 4000.0 - 0.5) * std::f64::consts::TAU;
            let (y, x) = (angle.sin() * 1.7, angle.cos() * 1.7);
            let (turned, opened) = dispatch!(SimdLevel::new(), simd => {
                let (x, y) = (splat(simd, x as f32), splat(simd, y as f32));
                (atan2(simd, y, x).to_array()[3], acos(simd, splat(simd, angle.cos() as f32)).to_array()[5])
            });
            assert!((f64::from(turned) - angle).abs() < 0.1 * f64::from(ANGLE_ERROR), "{angle}: {turned}");
            let cosine = f64::from(angle.cos() as f32);
            assert!((f64::from(opened) - cosine.acos()).abs() < 0.3 * f64::from(ANGLE_ERROR), "{angle}: {opened}");
        }
    }
}
