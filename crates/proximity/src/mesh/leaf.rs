//! Eight triangles against eight: which of the 64 pairs may be within the limit.

use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{V3, W8, load_corners, rows8, splat8};
use super::limit::{Limit, Sight};
use super::placement::Pairing;
use super::tree::Leaf;

/// The pairs of triangles that may be within the limit, whose squares of gaps decide.
pub(super) fn near(level: Level, a: &Leaf, b: &Leaf, pairing: &Pairing, limit: &Limit, all: Pairs) -> u64 {
    dispatch!(level, simd => {
        let left = match &limit.sight {
            Some(sight) => {
                let of_a = Intervals::of_a(simd, a, sight);
                Facing::new(simd, b, sight).near(simd, &of_a, limit, all)
            }
            None => all,
        };
        if left.0 == 0 { 0 } else { along_normals(simd, a, b, pairing, limit, left).0 }
    })
}

/// The pairs of triangles that may touch.
pub(super) fn touching(level: Level, a: &Leaf, b: &Leaf, pairing: &Pairing, limit: &Limit, all: Pairs) -> u64 {
    dispatch!(level, simd => {
        let of_a = Intervals::own(simd, a);
        let left = Facing::new(simd, b, &pairing.axes).touching(simd, &of_a, limit, all);
        if left.0 == 0 { 0 } else { along_normals(simd, a, b, pairing, limit, left).0 }
    })
}

/// The pair that looks nearest.
pub(super) fn nearest(level: Level, a: &Leaf, b: &Leaf, sight: &Sight, all: Pairs) -> u32 {
    dispatch!(level, simd => {
        let of_a = Intervals::of_a(simd, a, sight);
        Facing::new(simd, b, sight).nearest(simd, &of_a, all)
    })
}

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

/// Eight triangles as intervals along the axes of a [`Sight`].
struct Intervals<S: Simd> {
    low: V3<W8<S>>,
    high: V3<W8<S>>,
}

impl<S: Simd> Intervals<S> {
    #[inline(always)]
    fn of_a(simd: S, leaf: &Leaf, sight: &Sight) -> Self {
        Self::along(simd, leaf, &sight.of_a, [0.0; 3])
    }

    /// Along the axes of the leaf's own mesh.
    #[inline(always)]
    fn own(simd: S, leaf: &Leaf) -> Self {
        let [p, q, r] = load_corners(simd, &leaf.corner);
        Self {
            low: V3(p.0.min(q.0).min(r.0), p.1.min(q.1).min(r.1), p.2.min(q.2).min(r.2)),
            high: V3(p.0.max(q.0).max(r.0), p.1.max(q.1).max(r.1), p.2.max(q.2).max(r.2)),
        }
    }

    #[inline(always)]
    fn of_b(simd: S, leaf: &Leaf, sight: &Sight) -> Self {
        Self::along(simd, leaf, &sight.of_b, sight.shift)
    }

    #[inline(always)]
    fn along(simd: S, leaf: &Leaf, axes: &[[f32; 3]; 3], shift: [f32; 3]) -> Self {
        let corners = load_corners(simd, &leaf.corner);
        let (n, u, v) = (
            range(splat8(simd, axes[0]), &corners),
            range(splat8(simd, axes[1]), &corners),
            range(splat8(simd, axes[2]), &corners),
        );
        let shift = splat8(simd, shift);
        Self { low: V3(n.0, u.0, v.0).plus(shift), high: V3(n.1, u.1, v.1).plus(shift) }
    }

    /// The intervals of all eight together.
    #[inline(always)]
    fn whole(&self) -> ([f32; 3], [f32; 3]) {
        let (l, h) = (self.low, self.high);
        ([l.0.reduce_min(), l.1.reduce_min(), l.2.reduce_min()], [h.0.reduce_max(), h.1.reduce_max(), h.2.reduce_max()])
    }
}

/// Eight triangles of B, ready to be compared with leaves of A.
struct Facing<S: Simd> {
    each: Intervals<S>,
    whole: ([f32; 3], [f32; 3]),
}

impl<S: Simd> Facing<S> {
    #[inline(always)]
    fn new(simd: S, leaf: &Leaf, sight: &Sight) -> Self {
        let each = Intervals::of_b(simd, leaf, sight);
        let whole = each.whole();
        Self { each, whole }
    }

    /// Squared distance of each triangle of A from all of B, at least.
    #[inline(always)]
    fn square_of_whole(&self, simd: S, a: &Intervals<S>) -> W8<S> {
        let (zero, (low, high)) = (W8::splat(simd, 0.0), &self.whole);
        let n = (W8::splat(simd, low[0]) - a.high.0).max(zero);
        let u = (W8::splat(simd, low[1]) - a.high.1).max(a.low.1 - high[1]).max(zero);
        let v = (W8::splat(simd, low[2]) - a.high.2).max(a.low.2 - high[2]).max(zero);
        n * n + u * u + v * v
    }

    /// Squared distance of each triangle of B from triangle `i` of A, at least.
    #[inline(always)]
    fn square(&self, simd: S, (low, high): &([[f32; 8]; 3], [[f32; 8]; 3]), i: usize) -> W8<S> {
        let (zero, b) = (W8::splat(simd, 0.0), &self.each);
        let n = (b.low.0 - high[0][i]).max(zero);
        let u = (b.low.1 - high[1][i]).max(W8::splat(simd, low[1][i]) - b.high.1).max(zero);
        let v = (b.low.2 - high[2][i]).max(W8::splat(simd, low[2][i]) - b.high.2).max(zero);
        n * n + u * u + v * v
    }

    /// Leaves out pairs that are farther apart than the limit.
    #[inline(always)]
    fn near(&self, simd: S, a: &Intervals<S>, limit: &Limit, pairs: Pairs) -> Pairs {
        let mut rows = !self.square_of_whole(simd, a).simd_gt(limit.squared).to_bitmask() & 0xff;
        if rows == 0 {
            return Pairs(0);
        }
        let ends = (stored(a.low), stored(a.high));
        let mut left = 0;
        while rows != 0 {
            let i = rows.trailing_zeros() as usize;
            rows &= rows - 1;
            let out = self.square(simd, &ends, i).simd_gt(limit.squared).to_bitmask();
            left |= (!out & 0xff) << (8 * i);
        }
        Pairs(left & pairs.0)
    }

    /// Leaves out pairs that some axis keeps farther apart than the limit.
    #[inline(always)]
    fn touching(&self, simd: S, a: &Intervals<S>, limit: &Limit, pairs: Pairs) -> Pairs {
        let (low, high) = &self.whole;
        let n = (W8::splat(simd, low[0]) - a.high.0).max(a.low.0 - high[0]);
        let u = (W8::splat(simd, low[1]) - a.high.1).max(a.low.1 - high[1]);
        let v = (W8::splat(simd, low[2]) - a.high.2).max(a.low.2 - high[2]);
        let mut rows = !n.max(u).max(v).simd_gt(limit.gap).to_bitmask() & 0xff;
        if rows == 0 {
            return Pairs(0);
        }
        let (low, high) = (stored(a.low), stored(a.high));
        let mut left = 0;
        while rows != 0 {
            let i = rows.trailing_zeros() as usize;
            rows &= rows - 1;
            let b = &self.each;
            let n = (b.low.0 - high[0][i]).max(W8::splat(simd, low[0][i]) - b.high.0);
            let u = (b.low.1 - high[1][i]).max(W8::splat(simd, low[1][i]) - b.high.1);
            let v = (b.low.2 - high[2][i]).max(W8::splat(simd, low[2][i]) - b.high.2);
            let out = n.max(u).max(v).simd_gt(limit.gap).to_bitmask();
            left |= (!out & 0xff) << (8 * i);
        }
        Pairs(left & pairs.0)
    }

    /// The pair that looks nearest.
    #[inline(always)]
    fn nearest(&self, simd: S, a: &Intervals<S>, pairs: Pairs) -> u32 {
        let ends = (stored(a.low), stored(a.high));
        let mut best = (f32::INFINITY, 0);
        let mut squares = [0.0f32; 8];
        for i in 0..8 {
            self.square(simd, &ends, i).store_slice(&mut squares);
            for (j, &square) in squares.iter().enumerate() {
                let bit = (8 * i + j) as u32;
                if pairs.0 >> bit & 1 == 1 && square < best.0 {
                    best = (square, bit);
                }
            }
        }
        best.1
    }
}

/// Leaves out pairs that the plane of either triangle keeps farther apart than the limit.
#[inline(always)]
fn along_normals<S: Simd>(simd: S, a: &Leaf, b: &Leaf, pairing: &Pairing, limit: &Limit, pairs: Pairs) -> Pairs {
    let ab = &pairing.ab;
    let (rows, shift) = (rows8(simd, &ab.m), splat8(simd, ab.t));
    let [p, q, r] = load_corners(simd, &b.corner);
    let of_b = [p.mapped(&rows).plus(shift), q.mapped(&rows).plus(shift), r.mapped(&rows).plus(shift)];
    let of_a = load_corners(simd, &a.corner);
    let (normal_a, low_a, high_a) = plane(simd, &of_a);
    let (normal_b, low_b, high_b) = plane(simd, &of_b);
    let normal_a = stored(normal_a);
    let (mut lows, mut highs) = ([0.0f32; 8], [0.0f32; 8]);
    low_a.store_slice(&mut lows);
    high_a.store_slice(&mut highs);
    let mut left = 0;
    for i in 0..8 {
        if (pairs.0 >> (8 * i)) as u8 == 0 {
            continue;
        }
        let n = splat8(simd, [normal_a[0][i], normal_a[1][i], normal_a[2][i]]);
        let (low, high) = range(n, &of_b);
        let from_a = (low - highs[i]).max(W8::splat(simd, lows[i]) - high);
        let corners = [one(simd, a, 0, i), one(simd, a, 1, i), one(simd, a, 2, i)];
        let (low, high) = range(normal_b, &corners);
        let from_b = (low - high_b).max(low_b - high);
        let out = from_a.max(from_b).simd_gt(limit.gap).to_bitmask();
        left |= (!out & 0xff) << (8 * i);
    }
    Pairs(left & pairs.0)
}

/// Corner `k` of triangle `i` in all lanes.
#[inline(always)]
fn one<S: Simd>(simd: S, leaf: &Leaf, k: usize, i: usize) -> V3<W8<S>> {
    splat8(simd, [leaf.corner[k][0][i], leaf.corner[k][1][i], leaf.corner[k][2][i]])
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
