//! Eight triangles against eight: which of the 64 pairs may be within the limit.

use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::gilbert::beyond;
use super::lanes::{V3, W8, load_corners, load8, rows8, splat8};
use super::limit::{Limit, Sight};
use super::placement::Pairing;
use super::tree::Leaf;

/// The pairs of triangles that may be within the limit, whose squares of gaps decide.
pub(super) fn near(
    level: Level,
    a: &Leaf,
    b: &Leaf,
    pairing: &Pairing,
    limit: &Limit,
    facing: &mut Facing,
    all: Pairs,
) -> u64 {
    dispatch!(level, simd => {
        let left = match &limit.sight {
            Some(sight) => {
                facing.turn(simd, b, sight);
                facing.near(simd, &Intervals::of_a(simd, a, sight), limit, all)
            }
            None => all,
        };
        if left.0 == 0 {
            return 0;
        }
        let of_b = seen_from_a(simd, b, pairing);
        let left = along_normals(simd, &load_corners(simd, &a.corner), &of_b, a, limit, left);
        match &limit.sight {
            Some(sight) => descent(simd, a, &of_b, sight, limit, left).0,
            None => left.0,
        }
    })
}

/// Leaves out pairs that a step towards their nearest points shows to be farther apart than the limit.
#[inline(always)]
fn descent<S: Simd>(simd: S, a: &Leaf, of_b: &Triangles<S>, sight: &Sight, limit: &Limit, pairs: Pairs) -> Pairs {
    let toward = splat8(simd, sight.of_a[0]);
    let mut left = 0;
    let mut rest = pairs.0;
    while rest != 0 {
        let i = rest.trailing_zeros() / 8;
        let row = (pairs.0 >> (8 * i)) & 0xff;
        rest &= !(0xff << (8 * i));
        let corners = [one(simd, a, 0, i as usize), one(simd, a, 1, i as usize), one(simd, a, 2, i as usize)];
        left |= (row & !beyond(simd, &corners, of_b, toward, limit.gap, row)) << (8 * i);
    }
    Pairs(left)
}

/// The pairs of triangles that may touch.
pub(super) fn touching(level: Level, a: &Leaf, b: &Leaf, pairing: &Pairing, limit: &Limit, all: Pairs) -> u64 {
    dispatch!(level, simd => {
        let (of_a, of_b) = (load_corners(simd, &a.corner), seen_from_a(simd, b, pairing));
        let left = boxes_touch(simd, &of_a, &of_b, limit, all);
        if left.0 == 0 { 0 } else { along_normals(simd, &of_a, &of_b, a, limit, left).0 }
    })
}

/// For every triangle of A the one of B that looks nearest.
pub(super) fn nearest(level: Level, a: &Leaf, b: &Leaf, sight: &Sight, all: Pairs) -> u64 {
    dispatch!(level, simd => {
        let of_a = Intervals::of_a(simd, a, sight);
        let mut facing = Facing::NOTHING;
        facing.turn(simd, b, sight);
        facing.nearest(simd, &of_a, all)
    })
}

type Triangles<S> = [V3<W8<S>>; 3];

/// Triangles of B in A's frame.
#[inline(always)]
fn seen_from_a<S: Simd>(simd: S, b: &Leaf, pairing: &Pairing) -> Triangles<S> {
    let (rows, shift) = (rows8(simd, &pairing.ab.m), splat8(simd, pairing.ab.t));
    let [p, q, r] = load_corners(simd, &b.corner);
    [p.placed(&rows, shift), q.placed(&rows, shift), r.placed(&rows, shift)]
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

    /// Along the axes of the frame that the corners are in.
    #[inline(always)]
    fn own([p, q, r]: &Triangles<S>) -> Self {
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

/// Eight triangles of B as intervals along the axes of sight, kept for the next leaf of A.
#[derive(Debug, Clone)]
pub(super) struct Facing {
    low: [[f32; 8]; 3],
    high: [[f32; 8]; 3],
    /// Lowest and highest of all eight.
    whole: ([f32; 3], [f32; 3]),
    known: bool,
}

impl Facing {
    pub const NOTHING: Self =
        Self { low: [[0.0; 8]; 3], high: [[0.0; 8]; 3], whole: ([0.0; 3], [0.0; 3]), known: false };

    /// What is known is of another leaf, or along other axes.
    pub fn forget(&mut self) {
        self.known = false;
    }

    /// Looks at the leaf, unless it is known already.
    #[inline(always)]
    fn turn<S: Simd>(&mut self, simd: S, leaf: &Leaf, sight: &Sight) {
        if self.known {
            return;
        }
        let each = Intervals::of_b(simd, leaf, sight);
        (self.low, self.high, self.whole, self.known) = (stored(each.low), stored(each.high), each.whole(), true);
    }

    #[inline(always)]
    fn each<S: Simd>(&self, simd: S) -> Intervals<S> {
        Intervals { low: load8(simd, &self.low), high: load8(simd, &self.high) }
    }

    /// Squared distance of each triangle of A from all of B, at least.
    #[inline(always)]
    fn square_of_whole<S: Simd>(&self, simd: S, a: &Intervals<S>) -> W8<S> {
        let (zero, (low, high)) = (W8::splat(simd, 0.0), &self.whole);
        let n = (W8::splat(simd, low[0]) - a.high.0).max(zero);
        let u = (W8::splat(simd, low[1]) - a.high.1).max(a.low.1 - high[1]).max(zero);
        let v = (W8::splat(simd, low[2]) - a.high.2).max(a.low.2 - high[2]).max(zero);
        n * n + u * u + v * v
    }

    /// Leaves out pairs that are farther apart than the limit.
    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, a: &Intervals<S>, limit: &Limit, pairs: Pairs) -> Pairs {
        let mut rows = !self.square_of_whole(simd, a).simd_gt(limit.squared).to_bitmask() & 0xff;
        if rows == 0 {
            return Pairs(0);
        }
        let (ends, b) = ((stored(a.low), stored(a.high)), self.each(simd));
        let mut left = 0;
        while rows != 0 {
            let i = rows.trailing_zeros() as usize;
            rows &= rows - 1;
            let out = square(simd, &b, &ends, i).simd_gt(limit.squared).to_bitmask();
            left |= (!out & 0xff) << (8 * i);
        }
        Pairs(left & pairs.0)
    }

    /// For every triangle of A the one that looks nearest.
    #[inline(always)]
    fn nearest<S: Simd>(&self, simd: S, a: &Intervals<S>, pairs: Pairs) -> u64 {
        let (ends, b) = ((stored(a.low), stored(a.high)), self.each(simd));
        let mut squares = [0.0f32; 8];
        let mut chosen = 0;
        for i in 0..8 {
            let mut best = (f32::INFINITY, 0);
            square(simd, &b, &ends, i).store_slice(&mut squares);
            for (j, &square) in squares.iter().enumerate() {
                let bit = 1 << (8 * i + j);
                if pairs.0 & bit != 0 && square < best.0 {
                    best = (square, bit);
                }
            }
            chosen |= best.1;
        }
        chosen
    }
}

/// Squared distance of each triangle of B from triangle `i` of A, at least.
#[inline(always)]
fn square<S: Simd>(simd: S, b: &Intervals<S>, (low, high): &([[f32; 8]; 3], [[f32; 8]; 3]), i: usize) -> W8<S> {
    let zero = W8::splat(simd, 0.0);
    let n = (b.low.0 - high[0][i]).max(zero);
    let u = (b.low.1 - high[1][i]).max(W8::splat(simd, low[1][i]) - b.high.1).max(zero);
    let v = (b.low.2 - high[2][i]).max(W8::splat(simd, low[2][i]) - b.high.2).max(zero);
    n * n + u * u + v * v
}

/// Leaves out pairs whose boxes, along A's axes, are farther apart than the limit.
#[inline(always)]
fn boxes_touch<S: Simd>(simd: S, a: &Triangles<S>, b: &Triangles<S>, limit: &Limit, pairs: Pairs) -> Pairs {
    let (a, b) = (Intervals::own(a), Intervals::own(b));
    let (low, high) = (stored(a.low), stored(a.high));
    let mut left = 0;
    for i in 0..8 {
        let x = (b.low.0 - high[0][i]).max(W8::splat(simd, low[0][i]) - b.high.0);
        let y = (b.low.1 - high[1][i]).max(W8::splat(simd, low[1][i]) - b.high.1);
        let z = (b.low.2 - high[2][i]).max(W8::splat(simd, low[2][i]) - b.high.2);
        let out = x.max(y).max(z).simd_gt(limit.gap).to_bitmask();
        left |= (!out & 0xff) << (8 * i);
    }
    Pairs(left & pairs.0)
}

/// Leaves out pairs that the plane of either triangle keeps farther apart than the limit; all in A's frame.
#[inline(always)]
fn along_normals<S: Simd>(
    simd: S,
    of_a: &Triangles<S>,
    of_b: &Triangles<S>,
    a: &Leaf,
    limit: &Limit,
    pairs: Pairs,
) -> Pairs {
    let (plane_a, plane_b) = (Plane::new(of_a, limit.gap), Plane::new(of_b, limit.gap));
    let normal_a = stored(plane_a.normal);
    let ends_a = stored(V3(plane_a.low, plane_a.high, plane_a.high));
    let mut left = 0;
    for i in 0..8 {
        if (pairs.0 >> (8 * i)) as u8 == 0 {
            continue;
        }
        let (low, high) = range(splat8(simd, [normal_a[0][i], normal_a[1][i], normal_a[2][i]]), of_b);
        let from_a = (low - ends_a[1][i]).max(W8::splat(simd, ends_a[0][i]) - high);
        let corners = [one(simd, a, 0, i), one(simd, a, 1, i), one(simd, a, 2, i)];
        let (low, high) = range(plane_b.normal, &corners);
        let from_b = (low - plane_b.high).max(plane_b.low - high);
        let out = from_a.max(from_b).simd_gt(0.0).to_bitmask();
        left |= (!out & 0xff) << (8 * i);
    }
    Pairs(left & pairs.0)
}

/// Corner `k` of triangle `i` in all lanes.
#[inline(always)]
fn one<S: Simd>(simd: S, leaf: &Leaf, k: usize, i: usize) -> V3<W8<S>> {
    splat8(simd, [leaf.corner[k][0][i], leaf.corner[k][1][i], leaf.corner[k][2][i]])
}

/// Planes of triangles: normals of any length, and the interval of each triangle along its own, grown by the limit
/// times that length (or more).
struct Plane<S: Simd> {
    normal: V3<W8<S>>,
    low: W8<S>,
    high: W8<S>,
}

impl<S: Simd> Plane<S> {
    #[inline(always)]
    fn new(corners: &Triangles<S>, limit: f32) -> Self {
        let normal = corners[1].minus(corners[0]).cross(corners[2].minus(corners[0]));
        let (low, high) = range(normal, corners);
        // Squares of numbers this small are nothing to f32; their sum is longer than the normal, which is all it must be.
        let square = normal.dot(normal);
        let sum = normal.0.abs() + normal.1.abs() + normal.2.abs() + 1e-30;
        let length = square.simd_gt(1e-30).select(square.sqrt() * 1.000_001, sum);
        let grown = length * limit;
        Self { normal, low: low - grown, high: high + grown }
    }
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
