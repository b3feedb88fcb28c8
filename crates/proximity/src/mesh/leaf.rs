//! Eight triangles against eight: which of the 64 pairs may be within the limit.

use fearless_simd::{Simd, prelude::*};

use super::lanes::{V3, W8, load8, splat8};
use super::limit::Limit;
use super::placement::Pairing;
use super::tree::Leaf;

/// Bit `8 i + j`: triangle `i` of A and `j` of B.
#[derive(Clone, Copy)]
pub(super) struct Pairs(pub u64);

/// Only the lanes that hold triangles.
#[inline(always)]
pub(super) fn filled(count_a: usize, count_b: usize) -> Pairs {
    let row = (1u64 << count_b) - 1;
    let all = row * 0x0101_0101_0101_0101;
    Pairs(if count_a >= 8 { all } else { all & ((1 << (8 * count_a)) - 1) })
}

/// Leaves out pairs whose supports along the limit's direction stay apart.
#[inline(always)]
pub(super) fn along_direction<S: Simd>(simd: S, a: &Leaf, b: &Leaf, limit: &Limit, pairs: Pairs) -> Pairs {
    let of_a = support(simd, a, limit.direction_a);
    let of_b = support(simd, b, limit.direction_b.map(|x| -x));
    let mut each = [0.0f32; 8];
    of_a.store_slice(&mut each);
    let mut left = 0;
    for (i, &reach) in each.iter().enumerate() {
        let out = (of_b + reach).simd_lt(limit.reach).to_bitmask();
        left |= (!out & 0xff) << (8 * i);
    }
    Pairs(left & pairs.0)
}

#[inline(always)]
fn support<S: Simd>(simd: S, leaf: &Leaf, direction: [f32; 3]) -> W8<S> {
    let d = splat8(simd, direction);
    let at = |k: usize| load8(simd, &leaf.corner[k]).dot(d);
    at(0).max(at(1)).max(at(2))
}

/// Leaves out pairs that the plane of either triangle keeps farther apart than the limit.
#[inline(always)]
pub(super) fn along_normals<S: Simd>(
    simd: S,
    a: &Leaf,
    b: &Leaf,
    pairing: &Pairing,
    limit: &Limit,
    pairs: Pairs,
) -> Pairs {
    let ab = &pairing.ab;
    let rows = ab.m.map(|row| row.map(|x| W8::splat(simd, x)));
    let of_b: [V3<W8<S>>; 3] =
        std::array::from_fn(|k| load8(simd, &b.corner[k]).mapped(&rows).plus(splat8(simd, ab.t)));
    let of_a: [V3<W8<S>>; 3] = std::array::from_fn(|k| load8(simd, &a.corner[k]));
    let (normal_a, low_a, high_a) = plane(simd, &of_a);
    let (normal_b, low_b, high_b) = plane(simd, &of_b);
    let normal_a = stored(normal_a);
    let (mut lows, mut highs) = ([0.0f32; 8], [0.0f32; 8]);
    low_a.store_slice(&mut lows);
    high_a.store_slice(&mut highs);
    let mut left = 0;
    for i in 0..8 {
        if (pairs.0 >> (8 * i)) & 0xff == 0 {
            continue;
        }
        let n = splat8(simd, [normal_a[0][i], normal_a[1][i], normal_a[2][i]]);
        let (low, high) = range(n, &of_b);
        let from_a = (low - highs[i]).max(W8::splat(simd, lows[i]) - high);
        let corners: [V3<W8<S>>; 3] =
            std::array::from_fn(|k| splat8(simd, [a.corner[k][0][i], a.corner[k][1][i], a.corner[k][2][i]]));
        let (low, high) = range(normal_b, &corners);
        let from_b = (low - high_b).max(low_b - high);
        let out = from_a.max(from_b).simd_gt(limit.gap).to_bitmask();
        left |= (!out & 0xff) << (8 * i);
    }
    Pairs(left & pairs.0)
}

/// Normals no longer than 1, and the interval of each triangle along its own.
#[inline(always)]
fn plane<S: Simd>(simd: S, corners: &[V3<W8<S>>; 3]) -> (V3<W8<S>>, W8<S>, W8<S>) {
    let n = corners[1].minus(corners[0]).cross(corners[2].minus(corners[0]));
    // A triangle without area gets a normal too short to part anything.
    let square = n.dot(n).max(W8::splat(simd, 1e-30));
    let n = n.times(W8::splat(simd, 0.999_999) / square.sqrt());
    let (low, high) = range(n, corners);
    (n, low, high)
}

#[inline(always)]
fn range<S: Simd>(n: V3<W8<S>>, corners: &[V3<W8<S>>; 3]) -> (W8<S>, W8<S>) {
    let [x, y, z] = [n.dot(corners[0]), n.dot(corners[1]), n.dot(corners[2])];
    (x.min(y).min(z), x.max(y).max(z))
}

#[inline(always)]
fn stored<S: Simd>(v: V3<W8<S>>) -> [[f32; 8]; 3] {
    let mut out = [[0.0; 8]; 3];
    v.0.store_slice(&mut out[0]);
    v.1.store_slice(&mut out[1]);
    v.2.store_slice(&mut out[2]);
    out
}
