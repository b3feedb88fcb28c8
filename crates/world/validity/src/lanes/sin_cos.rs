//! Sine and cosine in lanes, after the single-precision functions of the Cephes library (Moshier, 1989).

use fearless_simd::{Simd, f32x16, i32x16, prelude::*};

use super::row::{Fused, splat};

/// π/2 in three parts; the first two have so few digits that their products with whole numbers up to 2¹³ are exact.
const HALF_PI: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];
const SIN: [f32; 3] = [-1.666_665_5e-1, 8.332_161e-3, -1.951_529_6e-4];
const COS: [f32; 3] = [4.166_664_6e-2, -1.388_731_6e-3, 2.443_315_7e-5];

/// Sine and cosine of angles up to 1000 rad. The error is below 1.5e-7.
#[inline(always)]
pub(crate) fn sin_cos<S: Simd>(simd: S, angle: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
    let quarter = (angle * splat(simd, std::f32::consts::FRAC_2_PI)).round_ties_even();
    let r = quarter.fused(splat(simd, -HALF_PI[0]), angle);
    let r = quarter.fused(splat(simd, -HALF_PI[1]), r);
    let r = quarter.fused(splat(simd, -HALF_PI[2]), r);
    let square = r * r;
    let sin = square.fused(splat(simd, SIN[2]), splat(simd, SIN[1])).fused(square, splat(simd, SIN[0]));
    let sin = (sin * square).fused(r, r);
    let cos = square.fused(splat(simd, COS[2]), splat(simd, COS[1])).fused(square, splat(simd, COS[0]));
    let cos = (cos * square).fused(square, square.fused(splat(simd, -0.5), splat(simd, 1.0)));
    let n: i32x16<S> = quarter.to_int();
    let one = i32x16::splat(simd, 1);
    let two = i32x16::splat(simd, 2);
    let is_odd = (n & one).simd_eq(one);
    let sin_sign: f32x16<S> = ((n & two) << 30).bitcast();
    let cos_sign: f32x16<S> = (((n + one) & two) << 30).bitcast();
    let (s, c) = (is_odd.select(cos, sin), is_odd.select(sin, cos));
    (flip(s, sin_sign), flip(c, cos_sign))
}

/// The value, with the opposite sign in lanes in which `sign` is −0.
#[inline(always)]
fn flip<S: Simd>(v: f32x16<S>, sign: f32x16<S>) -> f32x16<S> {
    let (v, sign): (i32x16<S>, i32x16<S>) = (v.bitcast(), sign.bitcast());
    (v ^ sign).bitcast()
}
