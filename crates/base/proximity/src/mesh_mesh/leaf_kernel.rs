//! The f32 kernel of leaves: finds which of the 64 pairs of eight triangles against eight may be within the cutoff.

use fearless_simd::{Simd, dispatch, prelude::*};

use super::cutoff::{Cutoff, WitnessFrame};
use super::gilbert::separated_lanes;
use super::mesh_pair::MeshPair;
use super::relative_placement::RelativePlacement;
use crate::bvh::Leaf;
use crate::lanes::{V3, W8, load_corners, load8, rows8, splat8, store8};

/// Two leaves, by their numbers in the trees.
#[derive(Clone, Copy)]
pub(super) struct LeafPair {
    pub a: usize,
    pub b: usize,
}

impl LeafPair {
    /// All pairs of their triangles.
    #[inline(always)]
    pub fn all(self, meshes: &MeshPair) -> PairMask {
        PairMask::full(meshes.a.bvh.leaf_len(self.a), meshes.b.bvh.leaf_len(self.b))
    }

    #[inline(always)]
    fn leaves<'m>(self, meshes: &MeshPair<'m>) -> (&'m Leaf, &'m Leaf) {
        (&meshes.a.bvh.leaves[self.a], &meshes.b.bvh.leaves[self.b])
    }
}

/// The pairs of triangles that may be within the cutoff, for a distance or tolerance query. `intervals` belong to the leaf
/// of B and are reused for the next leaf of A.
#[inline(always)]
pub(super) fn pairs_within<S: Simd>(
    simd: S,
    meshes: &MeshPair,
    leaves: LeafPair,
    cutoff: &Cutoff,
    intervals: &mut LeafIntervals,
) -> PairMask {
    let (a, b) = leaves.leaves(meshes);
    let all = leaves.all(meshes);
    let left = match &cutoff.witness_frame {
        Some(frame) => {
            intervals.compute(simd, b, frame);
            intervals.pairs_within(simd, &Intervals::of_a(simd, a, frame), cutoff, all)
        }
        None => all,
    };
    if left.is_empty() {
        return left;
    }
    let of_b = triangles_in_a(simd, b, meshes.placement);
    let left = by_normals(simd, &load_corners(simd, &a.corner), &of_b, a, cutoff, left);
    match &cutoff.witness_frame {
        Some(frame) => by_descent(simd, a, &of_b, frame, cutoff, left),
        None => left,
    }
}

/// Excludes pairs that Gilbert's descent proves to be farther apart than the cutoff.
#[inline(always)]
fn by_descent<S: Simd>(
    simd: S,
    a: &Leaf,
    of_b: &Triangles<S>,
    frame: &WitnessFrame,
    cutoff: &Cutoff,
    pairs: PairMask,
) -> PairMask {
    let toward = splat8(simd, frame.of_a[0]);
    let mut left = 0;
    let mut rest = pairs.0;
    while rest != 0 {
        let i = rest.trailing_zeros() / 8;
        let row = (pairs.0 >> (8 * i)) & 0xff;
        rest &= !(0xff << (8 * i));
        let corners = [one(simd, a, 0, i as usize), one(simd, a, 1, i as usize), one(simd, a, 2, i as usize)];
        left |= (row & !separated_lanes(simd, &corners, of_b, toward, cutoff.gap, row)) << (8 * i);
    }
    PairMask(left)
}

/// The pairs of triangles that may touch.
#[inline(always)]
pub(super) fn touching_pairs<S: Simd>(simd: S, meshes: &MeshPair, leaves: LeafPair, cutoff: &Cutoff) -> PairMask {
    let (a, b) = leaves.leaves(meshes);
    let all = leaves.all(meshes);
    let (of_a, of_b) = (load_corners(simd, &a.corner), triangles_in_a(simd, b, meshes.placement));
    let left = by_boxes(simd, &of_a, &of_b, cutoff, all);
    if left.is_empty() { left } else { by_normals(simd, &of_a, &of_b, a, cutoff, left) }
}

/// For every triangle of A, the triangle of B with the smallest lower bound.
pub(super) fn best_partners(meshes: &MeshPair, leaves: LeafPair, frame: &WitnessFrame) -> PairMask {
    let (a, b) = leaves.leaves(meshes);
    let all = leaves.all(meshes);
    dispatch!(meshes.simd_level, simd => {
        let of_a = Intervals::of_a(simd, a, frame);
        let mut intervals = LeafIntervals::UNKNOWN;
        intervals.compute(simd, b, frame);
        intervals.nearest(simd, &of_a, all)
    })
}

type Triangles<S> = [V3<W8<S>>; 3];

/// Triangles of B in A's frame.
#[inline(always)]
fn triangles_in_a<S: Simd>(simd: S, b: &Leaf, placement: &RelativePlacement) -> Triangles<S> {
    let (rows, shift) = (rows8(simd, &placement.b_in_a.m), splat8(simd, placement.b_in_a.t));
    let [p, q, r] = load_corners(simd, &b.corner);
    [p.placed(&rows, shift), q.placed(&rows, shift), r.placed(&rows, shift)]
}

/// A set of pairs of triangles: bit `8 i + j` is triangle `i` of A and `j` of B.
#[derive(Clone, Copy)]
pub(super) struct PairMask(pub u64);

impl PairMask {
    /// The lanes that contain triangles.
    #[inline(always)]
    fn full(count_a: usize, count_b: usize) -> Self {
        let row = (1u64 << count_b) - 1;
        let all = row * 0x0101_0101_0101_0101;
        Self(if count_a >= 8 { all } else { all & ((1 << (8 * count_a)) - 1) })
    }

    /// The pairs of the first triangle of A.
    #[inline(always)]
    pub fn first_row(self) -> Self {
        Self(self.0 & 0xff)
    }

    #[inline(always)]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// Lanes of the two triangles of each pair, in bit order.
    #[inline(always)]
    pub fn lanes(mut self) -> impl Iterator<Item = (u32, u32)> {
        std::iter::from_fn(move || {
            let bit = self.0.trailing_zeros();
            (self.0 != 0).then(|| {
                self.0 &= self.0 - 1;
                (bit / 8, bit % 8)
            })
        })
    }
}

/// Eight triangles as intervals along the axes of a [`WitnessFrame`].
struct Intervals<S: Simd> {
    low: V3<W8<S>>,
    high: V3<W8<S>>,
}

impl<S: Simd> Intervals<S> {
    #[inline(always)]
    fn of_a(simd: S, leaf: &Leaf, frame: &WitnessFrame) -> Self {
        Self::along(simd, leaf, &frame.of_a, [0.0; 3])
    }

    /// Intervals along the axes of the frame that the corners are in.
    #[inline(always)]
    fn own([p, q, r]: &Triangles<S>) -> Self {
        Self {
            low: V3(p.0.min(q.0).min(r.0), p.1.min(q.1).min(r.1), p.2.min(q.2).min(r.2)),
            high: V3(p.0.max(q.0).max(r.0), p.1.max(q.1).max(r.1), p.2.max(q.2).max(r.2)),
        }
    }

    #[inline(always)]
    fn of_b(simd: S, leaf: &Leaf, frame: &WitnessFrame) -> Self {
        Self::along(simd, leaf, &frame.of_b, frame.shift)
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

    /// The interval of all eight triangles together.
    #[inline(always)]
    fn whole(&self) -> ([f32; 3], [f32; 3]) {
        let (l, h) = (self.low, self.high);
        ([l.0.reduce_min(), l.1.reduce_min(), l.2.reduce_min()], [h.0.reduce_max(), h.1.reduce_max(), h.2.reduce_max()])
    }
}

/// Eight triangles of B as intervals along the axes of the witness frame, kept for the next leaf of A.
#[derive(Debug, Clone)]
pub(super) struct LeafIntervals {
    low: [[f32; 8]; 3],
    high: [[f32; 8]; 3],
    /// Lowest and highest value of all eight triangles.
    whole: ([f32; 3], [f32; 3]),
    known: bool,
}

impl LeafIntervals {
    pub const UNKNOWN: Self =
        Self { low: [[0.0; 8]; 3], high: [[0.0; 8]; 3], whole: ([0.0; 3], [0.0; 3]), known: false };

    /// Invalidates the intervals; call it before the leaf or the axes change.
    pub fn invalidate(&mut self) {
        self.known = false;
    }

    /// Computes the intervals unless they are known.
    #[inline(always)]
    fn compute<S: Simd>(&mut self, simd: S, leaf: &Leaf, frame: &WitnessFrame) {
        if self.known {
            return;
        }
        let each = Intervals::of_b(simd, leaf, frame);
        (self.low, self.high, self.whole, self.known) = (store8(each.low), store8(each.high), each.whole(), true);
    }

    #[inline(always)]
    fn each<S: Simd>(&self, simd: S) -> Intervals<S> {
        Intervals { low: load8(simd, &self.low), high: load8(simd, &self.high) }
    }

    /// Lower bound of the squared distance of each triangle of A from all triangles of B.
    #[inline(always)]
    fn square_of_whole<S: Simd>(&self, simd: S, a: &Intervals<S>) -> W8<S> {
        let (zero, (low, high)) = (W8::splat(simd, 0.0), &self.whole);
        let n = (W8::splat(simd, low[0]) - a.high.0).max(zero);
        let u = (W8::splat(simd, low[1]) - a.high.1).max(a.low.1 - high[1]).max(zero);
        let v = (W8::splat(simd, low[2]) - a.high.2).max(a.low.2 - high[2]).max(zero);
        n * n + u * u + v * v
    }

    /// Excludes pairs that are farther apart than the cutoff.
    #[inline(always)]
    fn pairs_within<S: Simd>(&self, simd: S, a: &Intervals<S>, cutoff: &Cutoff, pairs: PairMask) -> PairMask {
        let mut rows = !self.square_of_whole(simd, a).simd_gt(cutoff.squared).to_bitmask() & 0xff;
        if rows == 0 {
            return PairMask(0);
        }
        let (ends, b) = ((store8(a.low), store8(a.high)), self.each(simd));
        let mut left = 0;
        while rows != 0 {
            let i = rows.trailing_zeros() as usize;
            rows &= rows - 1;
            let out = square(simd, &b, &ends, i).simd_gt(cutoff.squared).to_bitmask();
            left |= (!out & 0xff) << (8 * i);
        }
        PairMask(left & pairs.0)
    }

    /// For every triangle of A, the triangle of B with the smallest lower bound.
    #[inline(always)]
    fn nearest<S: Simd>(&self, simd: S, a: &Intervals<S>, pairs: PairMask) -> PairMask {
        let (ends, b) = ((store8(a.low), store8(a.high)), self.each(simd));
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
        PairMask(chosen)
    }
}

/// Lower bound of the squared distance of each triangle of B from triangle `i` of A.
#[inline(always)]
fn square<S: Simd>(simd: S, b: &Intervals<S>, (low, high): &([[f32; 8]; 3], [[f32; 8]; 3]), i: usize) -> W8<S> {
    let zero = W8::splat(simd, 0.0);
    let n = (b.low.0 - high[0][i]).max(zero);
    let u = (b.low.1 - high[1][i]).max(W8::splat(simd, low[1][i]) - b.high.1).max(zero);
    let v = (b.low.2 - high[2][i]).max(W8::splat(simd, low[2][i]) - b.high.2).max(zero);
    n * n + u * u + v * v
}

/// Excludes pairs whose boxes, along A's axes, are farther apart than the cutoff.
#[inline(always)]
fn by_boxes<S: Simd>(simd: S, a: &Triangles<S>, b: &Triangles<S>, cutoff: &Cutoff, pairs: PairMask) -> PairMask {
    let (a, b) = (Intervals::own(a), Intervals::own(b));
    let (low, high) = (store8(a.low), store8(a.high));
    let mut left = 0;
    for i in 0..8 {
        let x = (b.low.0 - high[0][i]).max(W8::splat(simd, low[0][i]) - b.high.0);
        let y = (b.low.1 - high[1][i]).max(W8::splat(simd, low[1][i]) - b.high.1);
        let z = (b.low.2 - high[2][i]).max(W8::splat(simd, low[2][i]) - b.high.2);
        let out = x.max(y).max(z).simd_gt(cutoff.gap).to_bitmask();
        left |= (!out & 0xff) << (8 * i);
    }
    PairMask(left & pairs.0)
}

/// Excludes pairs that are farther apart than the cutoff along the normal of either triangle; all in A's frame.
#[inline(always)]
fn by_normals<S: Simd>(
    simd: S,
    of_a: &Triangles<S>,
    of_b: &Triangles<S>,
    a: &Leaf,
    cutoff: &Cutoff,
    pairs: PairMask,
) -> PairMask {
    let (plane_a, plane_b) = (TrianglePlanes::new(of_a, cutoff.gap), TrianglePlanes::new(of_b, cutoff.gap));
    let normal_a = store8(plane_a.normal);
    let ends_a = store8(V3(plane_a.low, plane_a.high, plane_a.high));
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
    PairMask(left & pairs.0)
}

/// Corner `k` of triangle `i` in all lanes.
#[inline(always)]
fn one<S: Simd>(simd: S, leaf: &Leaf, k: usize, i: usize) -> V3<W8<S>> {
    splat8(simd, [leaf.corner[k][0][i], leaf.corner[k][1][i], leaf.corner[k][2][i]])
}

/// Planes of triangles: normals of any length, and the interval of each triangle along its own normal, enlarged by
/// at least the gap of the cutoff times that length.
struct TrianglePlanes<S: Simd> {
    normal: V3<W8<S>>,
    low: W8<S>,
    high: W8<S>,
}

impl<S: Simd> TrianglePlanes<S> {
    #[inline(always)]
    fn new(corners: &Triangles<S>, gap: f32) -> Self {
        let normal = corners[1].minus(corners[0]).cross(corners[2].minus(corners[0]));
        let (low, high) = range(normal, corners);
        // Squares of such small numbers underflow. The sum of the coordinates is longer than the normal, which is
        // sufficient.
        let square = normal.dot(normal);
        let sum = normal.0.abs() + normal.1.abs() + normal.2.abs() + 1e-30;
        let length = square.simd_gt(1e-30).select(square.sqrt() * 1.000_001, sum);
        let grown = length * gap;
        Self { normal, low: low - grown, high: high + grown }
    }
}

#[inline(always)]
fn range<S: Simd>(n: V3<W8<S>>, corners: &[V3<W8<S>>; 3]) -> (W8<S>, W8<S>) {
    let [x, y, z] = [n.dot(corners[0]), n.dot(corners[1]), n.dot(corners[2])];
    (x.min(y).min(z), x.max(y).max(z))
}
