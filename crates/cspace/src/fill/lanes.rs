//! Sixteen numbers at once: angles of points and of cosines.
//!
//! No fused multiplications: a blocked cell does not depend on the instruction set.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};

pub(super) type F<S> = f32x16<S>;

/// Numbers in a vector.
pub(super) const WIDTH: usize = 16;

#[inline(always)]
pub(super) fn splat<S: Simd>(simd: S, value: f32) -> F<S> {
    F::splat(simd, value)
}

#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, from: &[f32]) -> F<S> {
    F::from_slice(simd, &from[..WIDTH])
}

/// `a·b + c` in two roundings.
#[inline(always)]
pub(super) fn mad<S: Simd>(a: F<S>, b: F<S>, c: F<S>) -> F<S> {
    a * b + c
}

/// Horner's scheme, the highest power last.
#[inline(always)]
fn polynomial<S: Simd>(simd: S, x: F<S>, coefficients: &[f32]) -> F<S> {
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

/// What [`atan2`] and [`acos`] may be wrong by, rounding included, with much room, radians.
pub(super) const ANGLE_ERROR: f32 = 1e-5;

/// Angle of the point (x, y), −π..π; 0 at the origin.
#[inline(always)]
pub(super) fn atan2<S: Simd>(simd: S, y: F<S>, x: F<S>) -> F<S> {
    let (ax, ay) = (x.abs(), y.abs());
    let steep = ay.simd_gt(ax);
    let ratio = ax.min(ay) / ax.max(ay).max(splat(simd, f32::MIN_POSITIVE));
    let shallow = ratio * polynomial(simd, ratio * ratio, &ATAN);
    let first = steep.select(splat(simd, std::f32::consts::FRAC_PI_2) - shallow, shallow);
    let half = x.simd_lt(splat(simd, 0.0)).select(splat(simd, std::f32::consts::PI) - first, first);
    half.copysign(y)
}

/// Angle of a cosine, 0..π; what is beyond ±1 counts as ±1.
#[inline(always)]
pub(super) fn acos<S: Simd>(simd: S, cosine: F<S>) -> F<S> {
    let t = cosine.abs().min(splat(simd, 1.0));
    let half = (splat(simd, 1.0) - t).sqrt() * polynomial(simd, t, &ACOS);
    cosine.simd_lt(splat(simd, 0.0)).select(splat(simd, std::f32::consts::PI) - half, half)
}

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch, prelude::*};

    use super::*;

    #[test]
    fn angles_are_right_to_a_tenth_of_the_margin() {
        for i in 0..4000 {
            let angle = (f64::from(i) / 4000.0 - 0.5) * std::f64::consts::TAU;
            let (y, x) = (angle.sin() * 1.7, angle.cos() * 1.7);
            let (turned, opened) = dispatch!(Level::new(), simd => {
                let (x, y) = (splat(simd, x as f32), splat(simd, y as f32));
                (atan2(simd, y, x).to_array()[3], acos(simd, splat(simd, angle.cos() as f32)).to_array()[5])
            });
            assert!((f64::from(turned) - angle).abs() < 0.1 * f64::from(ANGLE_ERROR), "{angle}: {turned}");
            let cosine = f64::from(angle.cos() as f32);
            assert!((f64::from(opened) - cosine.acos()).abs() < 0.3 * f64::from(ANGLE_ERROR), "{angle}: {opened}");
        }
    }
}
