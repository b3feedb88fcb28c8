//! Distances of eight pairs of triangles at once, in f64. README.md, "Triangles in f64".

use std::array::from_fn;

use fearless_simd::{Simd, f64x8, prelude::*};

use super::lanes::V3;

/// Pairs of one batch.
pub(super) const BATCH: usize = 8;

/// Corners of up to eight pairs, `[corner][axis][lane]`: A in its tree frame, B in its own.
#[derive(Debug, Clone)]
pub(super) struct Corners {
    pub a: [[[f64; BATCH]; 3]; 3],
    pub b: [[[f64; BATCH]; 3]; 3],
}

impl Corners {
    pub const ZERO: Self = Self { a: [[[0.0; BATCH]; 3]; 3], b: [[[0.0; BATCH]; 3]; 3] };
}

/// Per pair, in units of A.
#[derive(Debug, Clone)]
pub(super) struct Distances {
    /// Right to within the slack, where not doubtful.
    pub distance: [f64; BATCH],
    /// Where doubtful: the distance is not below this.
    pub at_least: [f64; BATCH],
}

type W<S> = f64x8<S>;
type Triangle<S> = [V3<W<S>>; 3];

/// A triangle with what several of its tests need.
struct Prepared<S: Simd> {
    corner: Triangle<S>,
    /// `edge[k]` runs from corner `k` to the next.
    edge: Triangle<S>,
    /// Squared lengths of the edges, and their inverses (0 for an edge without length).
    square: [W<S>; 3],
    inverse: [W<S>; 3],
    normal: V3<W<S>>,
    normal_square: W<S>,
    longest: W<S>,
}

impl<S: Simd> Prepared<S> {
    #[inline(always)]
    fn new(simd: S, corner: Triangle<S>) -> Self {
        let edge: Triangle<S> = from_fn(|k| corner[(k + 1) % 3].minus(corner[k]));
        let square: [W<S>; 3] = from_fn(|k| edge[k].dot(edge[k]));
        let tiny = W::splat(simd, f64::MIN_POSITIVE);
        let inverse = from_fn(|k| {
            let usable = square[k].simd_gt(tiny);
            usable.select(W::splat(simd, 1.0) / square[k].max(tiny), W::splat(simd, 0.0))
        });
        let normal = edge[0].cross(edge[1]);
        let longest = square[0].max(square[1]).max(square[2]);
        Self { corner, edge, square, inverse, normal, normal_square: normal.dot(normal), longest }
    }

    #[inline(always)]
    fn heights(&self, points: &Triangle<S>) -> [W<S>; 3] {
        from_fn(|k| self.normal.dot(points[k].minus(self.corner[0])))
    }
}

/// All distances of a batch; `exact` maps B's frame to A's.
#[inline(always)]
pub(super) fn distances<S: Simd>(simd: S, corners: &Corners, exact: &[[f64; 4]; 3]) -> Distances {
    let load = |p: &[[f64; BATCH]; 3]| {
        V3(W::load_array_ref(simd, &p[0]), W::load_array_ref(simd, &p[1]), W::load_array_ref(simd, &p[2]))
    };
    let rotation = exact.map(|row| [row[0], row[1], row[2]].map(|x| W::splat(simd, x)));
    let shift = V3(W::splat(simd, exact[0][3]), W::splat(simd, exact[1][3]), W::splat(simd, exact[2][3]));
    let a = Prepared::new(simd, from_fn(|k| load(&corners.a[k])));
    let b = Prepared::new(simd, from_fn(|k| load(&corners.b[k]).mapped(&rotation).plus(shift)));
    let between: [[V3<W<S>>; 3]; 3] = from_fn(|i| from_fn(|j| a.corner[i].minus(b.corner[j])));
    let zero = W::splat(simd, 0.0);
    let (mut best, mut doubt) = edges(simd, &a, &b, &between);
    let (heights_a, heights_b) = (b.heights(&a.corner), a.heights(&b.corner));
    // Along edges and normals, of corners of A over B and of B over A.
    let below = |x: &Prepared<S>, k: usize, r: [V3<W<S>>; 3], sign: f64| {
        // r[j] runs from corner j of x to the point (times sign).
        let s = W::splat(simd, sign);
        (x.edge[0].dot(r[0]) * s, x.edge[2].dot(r[0]) * s, k)
    };
    for k in 0..3 {
        let (d0, d2, _) = below(&b, k, between[k], 1.0);
        best = best.min(over_face(simd, &b, d0, d2, heights_a[k]));
        let (d0, d2, _) = below(&a, k, from_fn(|j| between[j][k]), -1.0);
        best = best.min(over_face(simd, &a, d0, d2, heights_b[k]));
    }
    let slender = slender(simd, &a) | slender(simd, &b);
    let crossed = crossing(simd, &a, &b, &heights_a, &heights_b);
    // What slender triangles cross is looked at again.
    doubt = doubt | slender;
    best = crossed.select(zero, best);
    let distance = best.sqrt();
    let margin = a.longest.max(b.longest).sqrt() * DOUBTFUL_SHARE;
    let at_least = (crossed & slender).select(zero, doubt.select(distance - margin, distance));
    let mut out = Distances { distance: [0.0; BATCH], at_least: [0.0; BATCH] };
    distance.store_slice(&mut out.distance);
    at_least.store_slice(&mut out.at_least);
    // A crossing of slender triangles is no proof: infinite until settled.
    let claimed = (crossed & slender).select(W::splat(simd, f64::INFINITY), distance);
    claimed.store_slice(&mut out.distance);
    out
}

/// Squared sine below which two edges count as nearly parallel.
const PARALLEL: f64 = 1e-6;
/// Squared ratio of height to longest edge below which a triangle is slender.
const SLENDER: f64 = 1e-4;
/// What a doubtful distance may be too large by, as a share of the longest edge: the width of a slender triangle (1e-2)
/// or what nearly parallel edges diverge over their length (1e-3), doubled.
const DOUBTFUL_SHARE: f64 = 0.022;

#[inline(always)]
fn slender<S: Simd>(simd: S, t: &Prepared<S>) -> <W<S> as SimdBase<S>>::Mask {
    !(t.normal_square.simd_gt(t.longest * t.longest * SLENDER)) | t.longest.simd_le(W::splat(simd, 1e-140))
}

/// Smallest squared distance of the nine pairs of edges (Ericson, 2005, 5.1.9), and where it is doubtful.
#[inline(always)]
fn edges<S: Simd>(
    simd: S,
    a: &Prepared<S>,
    b: &Prepared<S>,
    between: &[[V3<W<S>>; 3]; 3],
) -> (W<S>, <W<S> as SimdBase<S>>::Mask) {
    let (zero, one) = (W::splat(simd, 0.0), W::splat(simd, 1.0));
    let mut best = W::splat(simd, f64::INFINITY);
    let mut doubt = one.simd_lt(zero);
    for i in 0..3 {
        for j in 0..3 {
            let r = between[i][j];
            let (u, v) = (a.edge[i], b.edge[j]);
            let along = u.dot(v);
            let c = u.dot(r);
            let f = v.dot(r);
            let full = a.square[i] * b.square[j];
            let across = full - along * along;
            let parallel = across.simd_le(full * PARALLEL);
            doubt = doubt | parallel;
            let s = (along * f - c * b.square[j]) / parallel.select(one, across);
            let s = parallel.select(zero, s).max(zero).min(one);
            let t = ((along * s + f) * b.inverse[j]).max(zero).min(one);
            let s = ((along * t - c) * a.inverse[i]).max(zero).min(one);
            let gap = r.plus(u.times(s)).minus(v.times(t));
            best = best.min(gap.dot(gap));
        }
    }
    (best, doubt)
}

/// Squared height of a point where its foot is inside the triangle, else infinite. `d0`, `d2` are products of the
/// vector from corner 0 with the first and the last edge.
#[inline(always)]
fn over_face<S: Simd>(simd: S, t: &Prepared<S>, d0: W<S>, d2: W<S>, height: W<S>) -> W<S> {
    let zero = W::splat(simd, 0.0);
    // The sides at corner 0 are edge 0 and minus edge 2.
    let mixed = zero - t.edge[0].dot(t.edge[2]);
    let d2 = zero - d2;
    let u = t.square[2] * d0 - mixed * d2;
    let w = t.square[0] * d2 - mixed * d0;
    let whole = t.square[0] * t.square[2] - mixed * mixed;
    let inside = u.simd_gt(zero) & w.simd_gt(zero) & (u + w).simd_lt(whole);
    let tiny = W::splat(simd, f64::MIN_POSITIVE);
    let flat = t.normal_square.simd_gt(t.longest * t.longest * SLENDER);
    (inside & flat).select(height * height / t.normal_square.max(tiny), W::splat(simd, f64::INFINITY))
}

/// Where an edge of one triangle passes through the other.
#[inline(always)]
fn crossing<S: Simd>(
    simd: S,
    a: &Prepared<S>,
    b: &Prepared<S>,
    heights_a: &[W<S>; 3],
    heights_b: &[W<S>; 3],
) -> <W<S> as SimdBase<S>>::Mask {
    let zero = W::splat(simd, 0.0);
    let cut = |h: &[W<S>; 3]| {
        let low = h[0].min(h[1]).min(h[2]);
        let high = h[0].max(h[1]).max(h[2]);
        low.simd_le(zero) & high.simd_ge(zero)
    };
    let both = cut(heights_a) & cut(heights_b);
    if !both.any_true() {
        return both;
    }
    (pierced(simd, a, b, heights_a) | pierced(simd, b, a, heights_b)) & both
}

/// Where an edge of `t`, whose corners have these heights over `f`, passes through `f`.
#[inline(always)]
fn pierced<S: Simd>(simd: S, t: &Prepared<S>, f: &Prepared<S>, heights: &[W<S>; 3]) -> <W<S> as SimdBase<S>>::Mask {
    let zero = W::splat(simd, 0.0);
    let mut any = zero.simd_lt(zero);
    for k in 0..3 {
        let (p, q) = (heights[k], heights[(k + 1) % 3]);
        let apart = !(p.simd_gt(zero).simd_eq(q.simd_gt(zero)));
        let share = p / apart.select(p - q, W::splat(simd, 1.0));
        let x = t.corner[k].plus(t.edge[k].times(share));
        let mut inside = apart;
        for l in 0..3 {
            let side = f.normal.dot(f.edge[l].cross(x.minus(f.corner[l])));
            inside = inside & side.simd_ge(zero);
        }
        any = any | inside;
    }
    any
}
