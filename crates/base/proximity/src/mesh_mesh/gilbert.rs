//! Separation of triangles by Gilbert's descent towards the closest points. Every step gives a candidate for a
//! separating direction.
//!
//! Source: E. G. Gilbert, *An iterative procedure for computing the minimum of a quadratic form on a convex set*,
//! SIAM J. Control 4 (1966). A gap measured along any direction is a lower bound of the distance. Along the closest
//! points it is the distance itself, and the bound converges to it quadratically. So few steps are sufficient, and
//! they need not be exact.

use fearless_simd::{Simd, prelude::*};

use crate::lanes::{V3, W8};

/// Largest number of steps. More steps separate hardly any more pairs.
const STEPS: usize = 2;

/// The lanes of `of_b` that are farther than `gap` from the triangle in all lanes of `of_a`.
///
/// `toward` points roughly from A to B, with any length. Only the lanes in `candidates` matter.
#[inline(always)]
pub(super) fn separated_lanes<S: Simd>(
    simd: S,
    of_a: &[V3<W8<S>>; 3],
    of_b: &[V3<W8<S>>; 3],
    toward: V3<W8<S>>,
    gap: f32,
    candidates: u64,
) -> u64 {
    let (mut out, mut v) = (0, support_gap(of_a, of_b, toward).0);
    for _ in 0..STEPS {
        let (w, lower) = support_gap(of_a, of_b, v);
        let square = v.dot(v);
        // An upper bound of the length of `v`, positive even if `v` is 0: the test is conservative.
        let length = square.sqrt() * 1.000_001 + 1e-18;
        out |= lower.simd_gt(length * gap).to_bitmask();
        if candidates & !out == 0 {
            break;
        }
        // The point of the segment from v to w that is nearest to the origin.
        let e = w.minus(v);
        let (along, whole) = (v.dot(e), e.dot(e));
        let zero = W8::splat(simd, 0.0);
        let t = ((zero - along) / whole.max(W8::splat(simd, 1e-30))).max(zero).min(W8::splat(simd, 1.0));
        v = V3(e.0.mul_add(t, v.0), e.1.mul_add(t, v.1), e.2.mul_add(t, v.2));
    }
    out
}

/// The difference of the support points of B against `d` and of A along `d`, and the gap between them along `d`,
/// times the length of `d`.
#[inline(always)]
fn support_gap<S: Simd>(of_a: &[V3<W8<S>>; 3], of_b: &[V3<W8<S>>; 3], d: V3<W8<S>>) -> (V3<W8<S>>, W8<S>) {
    let (a, far) = lowest(of_a, V3(-d.0, -d.1, -d.2));
    let (b, near) = lowest(of_b, d);
    (b.minus(a), near + far)
}

/// The corner with the least height along `d`, and its height.
#[inline(always)]
fn lowest<S: Simd>(corners: &[V3<W8<S>>; 3], d: V3<W8<S>>) -> (V3<W8<S>>, W8<S>) {
    let [p, q, r] = corners;
    let (x, y, z) = (p.dot(d), q.dot(d), r.dot(d));
    let second = y.simd_lt(x);
    let least = second.select(y, x);
    let chosen = V3(second.select(q.0, p.0), second.select(q.1, p.1), second.select(q.2, p.2));
    let third = z.simd_lt(least);
    let chosen = V3(third.select(r.0, chosen.0), third.select(r.1, chosen.1), third.select(r.2, chosen.2));
    (chosen, third.select(z, least))
}
