//! The f64 kernel of triangles: distances of eight pairs of triangles at once. README.md, "Triangles in f64",
//! describes it.

use fearless_simd::{Simd, f64x8, prelude::*};

use elbowroom_spatial::Vec3;

use super::relative_placement::RelativePlacement;
use crate::bvh::UnitFrame;
use crate::lanes::V3;
use crate::triangle::ClosestPoints;

/// Number of pairs of one batch.
pub(super) const BATCH: usize = 8;

/// Corners of up to eight pairs, `[corner][axis][lane]`, each mesh in its own frame, metres.
#[derive(Debug, Clone)]
pub(super) struct Corners {
    pub a: [[[f64; BATCH]; 3]; 3],
    pub b: [[[f64; BATCH]; 3]; 3],
}

impl Corners {
    pub const ZERO: Self = Self { a: [[[0.0; BATCH]; 3]; 3], b: [[[0.0; BATCH]; 3]; 3] };
}

/// Distances of the pairs of a batch, in units of A.
#[derive(Debug, Clone)]
pub(super) struct Distances {
    /// Distance, exact to within the f64 error if it is certain: see `at_least`.
    pub distance: [f64; BATCH],
    /// Lower bound of the true distance. If it is smaller than `distance`, the distance is uncertain.
    pub at_least: [f64; BATCH],
    on_a: [[f64; BATCH]; 3],
    apart: [[f64; BATCH]; 3],
}

impl Distances {
    /// True if the distance and the closest points of one pair are certain.
    #[inline(always)]
    pub fn is_certain(&self, lane: usize) -> bool {
        self.at_least[lane] >= self.distance[lane]
    }

    /// Closest points of one pair; valid if they are certain.
    #[inline(always)]
    pub fn closest_points(&self, lane: usize) -> ClosestPoints {
        let on_a = Vec3::new(self.on_a[0][lane], self.on_a[1][lane], self.on_a[2][lane]);
        let apart = Vec3::new(self.apart[0][lane], self.apart[1][lane], self.apart[2][lane]);
        ClosestPoints { squared: self.distance[lane] * self.distance[lane], on_a, on_b: on_a - apart }
    }
}

type W<S> = f64x8<S>;
type Triangle<S> = [V3<W<S>>; 3];

/// A triangle with the quantities that several tests share.
struct Prepared<S: Simd> {
    corner: Triangle<S>,
    /// Edges: `edge[k]` runs from corner `k` to the next.
    edge: Triangle<S>,
    /// Squared lengths of the edges, and their inverses (0 for an edge without length).
    square: [W<S>; 3],
    inverse: [W<S>; 3],
    normal: V3<W<S>>,
    normal_square: W<S>,
    /// 1 over the square of the normal; 0 if the normal has no length.
    normal_inverse: W<S>,
    longest: W<S>,
}

impl<S: Simd> Prepared<S> {
    #[inline(always)]
    fn new(simd: S, corner: Triangle<S>) -> Self {
        let edge: Triangle<S> = [corner[1].minus(corner[0]), corner[2].minus(corner[1]), corner[0].minus(corner[2])];
        let square = [edge[0].dot(edge[0]), edge[1].dot(edge[1]), edge[2].dot(edge[2])];
        let inverse = [reciprocal(simd, square[0]), reciprocal(simd, square[1]), reciprocal(simd, square[2])];
        let normal = edge[0].cross(edge[1]);
        let longest = square[0].max(square[1]).max(square[2]);
        let normal_square = normal.dot(normal);
        let normal_inverse = reciprocal(simd, normal_square);
        Self { corner, edge, square, inverse, normal, normal_square, normal_inverse, longest }
    }

    #[inline(always)]
    fn heights(&self, points: &Triangle<S>) -> [W<S>; 3] {
        let one = self.normal.dot(points[0].minus(self.corner[0]));
        let two = self.normal.dot(points[1].minus(self.corner[0]));
        [one, two, self.normal.dot(points[2].minus(self.corner[0]))]
    }
}

/// 1/x, or 0 if x is too small for it.
#[inline(always)]
fn reciprocal<S: Simd>(simd: S, x: W<S>) -> W<S> {
    let tiny = W::splat(simd, f64::MIN_POSITIVE);
    x.simd_gt(tiny).select(W::splat(simd, 1.0) / x.max(tiny), W::splat(simd, 0.0))
}

/// A corner in its mesh's unit frame, rounded as by [`UnitFrame::to_units`].
#[inline(always)]
fn load<S: Simd>(simd: S, p: &[[f64; BATCH]; 3], frame: &UnitFrame) -> V3<W<S>> {
    V3(
        (W::load_array_ref(simd, &p[0]) - frame.center.x) * frame.inverse,
        (W::load_array_ref(simd, &p[1]) - frame.center.y) * frame.inverse,
        (W::load_array_ref(simd, &p[2]) - frame.center.z) * frame.inverse,
    )
}

/// All distances of a batch.
#[inline(always)]
pub(super) fn distances<S: Simd>(simd: S, corners: &Corners, placement: &RelativePlacement) -> Distances {
    let (fa, fb) = (&placement.frame_a, &placement.frame_b);
    let a = Prepared::new(
        simd,
        [load(simd, &corners.a[0], fa), load(simd, &corners.a[1], fa), load(simd, &corners.a[2], fa)],
    );
    let [x, y, z] = &placement.exact;
    let rows = [row(simd, x), row(simd, y), row(simd, z)];
    let shift = V3(W::splat(simd, x[3]), W::splat(simd, y[3]), W::splat(simd, z[3]));
    let b = Prepared::new(
        simd,
        [
            load(simd, &corners.b[0], fb).mapped(&rows).plus(shift),
            load(simd, &corners.b[1], fb).mapped(&rows).plus(shift),
            load(simd, &corners.b[2], fb).mapped(&rows).plus(shift),
        ],
    );
    let zero = W::splat(simd, 0.0);
    let mut best = Best { square: W::splat(simd, f64::INFINITY), on_a: a.corner[0], apart: a.corner[0] };
    let spread = edges(simd, &a, &b, &mut best);
    let (heights_a, heights_b) = (b.heights(&a.corner), a.heights(&b.corner));
    for k in 0..3 {
        let over_b = height_over(simd, &b, a.corner[k], heights_a[k]);
        best.keep(over_b.square, a.corner[k], over_b.offset);
        let over_a = height_over(simd, &a, b.corner[k], heights_b[k]);
        let apart = V3(zero - over_a.offset.0, zero - over_a.offset.1, zero - over_a.offset.2);
        best.keep(over_a.square, b.corner[k].plus(apart), apart);
    }
    let slender = slender(simd, &a) | slender(simd, &b);
    let crossed = crossing(simd, &a, &b, &heights_a, &heights_b, &mut best);
    let distance = best.square.sqrt();
    // The width of a slender triangle (1e-2), or the divergence of nearly parallel edges over their length; doubled.
    let share = slender.select(W::splat(simd, 0.022), spread.sqrt() * 2.0);
    let margin = a.longest.max(b.longest).sqrt() * share;
    // A crossing of slender triangles is not a proof either.
    let at_least = (crossed & slender).select(zero - 1.0, distance - margin);
    let mut out =
        Distances { distance: [0.0; BATCH], at_least: [0.0; BATCH], on_a: [[0.0; BATCH]; 3], apart: [[0.0; BATCH]; 3] };
    distance.store_slice(&mut out.distance);
    at_least.store_slice(&mut out.at_least);
    store(best.on_a, &mut out.on_a);
    store(best.apart, &mut out.apart);
    out
}

/// The closest points so far.
struct Best<S: Simd> {
    square: W<S>,
    on_a: V3<W<S>>,
    /// Vector from the point of B to the point of A.
    apart: V3<W<S>>,
}

impl<S: Simd> Best<S> {
    #[inline(always)]
    fn keep(&mut self, square: W<S>, on_a: V3<W<S>>, apart: V3<W<S>>) {
        let nearer = square.simd_lt(self.square);
        self.square = nearer.select(square, self.square);
        self.on_a = select(nearer, on_a, self.on_a);
        self.apart = select(nearer, apart, self.apart);
    }
}

type M<S> = <W<S> as SimdBase<S>>::Mask;

#[inline(always)]
fn select<S: Simd>(mask: M<S>, a: V3<W<S>>, b: V3<W<S>>) -> V3<W<S>> {
    V3(mask.select(a.0, b.0), mask.select(a.1, b.1), mask.select(a.2, b.2))
}

#[inline(always)]
fn store<S: Simd>(v: V3<W<S>>, to: &mut [[f64; BATCH]; 3]) {
    v.0.store_slice(&mut to[0]);
    v.1.store_slice(&mut to[1]);
    v.2.store_slice(&mut to[2]);
}

#[inline(always)]
fn row<S: Simd>(simd: S, r: &[f64; 4]) -> [W<S>; 3] {
    [W::splat(simd, r[0]), W::splat(simd, r[1]), W::splat(simd, r[2])]
}

/// Squared sine below which two edges count as nearly parallel.
const PARALLEL: f64 = 1e-6;
/// Squared ratio of height to longest edge below which a triangle is slender.
const SLENDER: f64 = 1e-4;
#[inline(always)]
fn slender<S: Simd>(simd: S, t: &Prepared<S>) -> <W<S> as SimdBase<S>>::Mask {
    !(t.normal_square.simd_gt(t.longest * t.longest * SLENDER)) | t.longest.simd_le(W::splat(simd, 1e-140))
}

/// Closest points of the nine pairs of edges (Ericson, 2005, 5.1.9). Returns the largest squared sine among nearly
/// parallel pairs, whose parameters are ill-conditioned; 0 without such pairs.
#[inline(always)]
fn edges<S: Simd>(simd: S, a: &Prepared<S>, b: &Prepared<S>, best: &mut Best<S>) -> W<S> {
    let (zero, one) = (W::splat(simd, 0.0), W::splat(simd, 1.0));
    let mut spread = zero;
    for i in 0..3 {
        for j in 0..3 {
            let r = a.corner[i].minus(b.corner[j]);
            let (u, v) = (a.edge[i], b.edge[j]);
            let along = u.dot(v);
            let c = u.dot(r);
            let f = v.dot(r);
            let full = a.square[i] * b.square[j];
            let across = full - along * along;
            let parallel = across.simd_le(full * PARALLEL);
            // Adds the error that cancellation may hide.
            let sine = across.max(zero) * a.inverse[i] * b.inverse[j] + 1e-15;
            spread = spread.max(parallel.select(sine, zero));
            let s = (along * f - c * b.square[j]) / parallel.select(one, across);
            let s = parallel.select(zero, s).max(zero).min(one);
            let t = ((along * s + f) * b.inverse[j]).max(zero).min(one);
            let s = ((along * t - c) * a.inverse[i]).max(zero).min(one);
            let step = u.times(s);
            let gap = r.plus(step).minus(v.times(t));
            best.keep(gap.dot(gap), a.corner[i].plus(step), gap);
        }
    }
    spread
}

/// The projection of a point onto the plane of a triangle.
struct Projection<S: Simd> {
    /// Squared height if the projected point is inside the triangle, else infinite.
    square: W<S>,
    /// Vector from the projected point to the point.
    offset: V3<W<S>>,
}

/// Projects `point` onto the triangle; `height` is the dot product of the normal and the point minus a corner.
#[inline(always)]
fn height_over<S: Simd>(simd: S, t: &Prepared<S>, point: V3<W<S>>, height: W<S>) -> Projection<S> {
    let (zero, r) = (W::splat(simd, 0.0), point.minus(t.corner[0]));
    // The sides at corner 0 are edge 0 and minus edge 2.
    let mixed = zero - t.edge[0].dot(t.edge[2]);
    let (d0, d2) = (t.edge[0].dot(r), zero - t.edge[2].dot(r));
    let u = t.square[2] * d0 - mixed * d2;
    let w = t.square[0] * d2 - mixed * d0;
    let determinant = t.square[0] * t.square[2] - mixed * mixed;
    let inside = u.simd_gt(zero) & w.simd_gt(zero) & (u + w).simd_lt(determinant);
    let certain = t.normal_square.simd_gt(t.longest * t.longest * SLENDER);
    let share = height * t.normal_inverse;
    let square = (inside & certain).select(height * share, W::splat(simd, f64::INFINITY));
    Projection { square, offset: t.normal.times(share) }
}

/// The lanes in which an edge of one triangle passes through the other; stores the point of intersection.
#[inline(always)]
fn crossing<S: Simd>(
    simd: S,
    a: &Prepared<S>,
    b: &Prepared<S>,
    heights_a: &[W<S>; 3],
    heights_b: &[W<S>; 3],
    best: &mut Best<S>,
) -> M<S> {
    let zero = W::splat(simd, 0.0);
    let both = intersects_plane(zero, heights_a) & intersects_plane(zero, heights_b);
    if !both.any_true() {
        return both;
    }
    let mut any = zero.simd_lt(zero);
    for k in 0..3 {
        let through_b = pierced(simd, a, b, heights_a, k);
        let through_a = pierced(simd, b, a, heights_b, k);
        for (mask, point) in [through_b, through_a] {
            let mask = mask & both;
            any |= mask;
            best.square = mask.select(zero, best.square);
            best.on_a = select(mask, point, best.on_a);
            best.apart = select(mask, V3(zero, zero, zero), best.apart);
        }
    }
    any
}

/// The lanes in which the heights have both signs, or one is 0: the plane intersects the triangle.
#[inline(always)]
fn intersects_plane<S: Simd>(zero: W<S>, h: &[W<S>; 3]) -> M<S> {
    h[0].min(h[1]).min(h[2]).simd_le(zero) & h[0].max(h[1]).max(h[2]).simd_ge(zero)
}

/// The lanes in which edge `k` of `t`, whose corners have these heights over `f`, passes through `f`, and the point.
#[inline(always)]
fn pierced<S: Simd>(simd: S, t: &Prepared<S>, f: &Prepared<S>, heights: &[W<S>; 3], k: usize) -> (M<S>, V3<W<S>>) {
    let zero = W::splat(simd, 0.0);
    let (p, q) = (heights[k], heights[(k + 1) % 3]);
    let apart = !(p.simd_gt(zero).simd_eq(q.simd_gt(zero)));
    let share = p / apart.select(p - q, W::splat(simd, 1.0));
    let x = t.corner[k].plus(t.edge[k].times(share));
    let mut inside = apart;
    for l in 0..3 {
        let side = f.normal.dot(f.edge[l].cross(x.minus(f.corner[l])));
        inside &= side.simd_ge(zero);
    }
    (inside, x)
}
