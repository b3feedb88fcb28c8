//! The wrist's sphere and its outline, sixteen rows at a time.

use elbowroom_validity::lanes::simd::{Select, Simd, SimdBase, SimdFloat, SimdMask};

use super::context::{ConvexContext, Outlines};
use super::corner_tests::{CornerTests, Mask, Points};
use super::normals::OutlineNormals;
use super::outline::Outline;
use super::row_culling::RowCulling;
use super::simd_math::{Lanes, mad, splat};
use crate::bits::ones;

/// Points at which the wrist, on its circle about the elbow, enters and leaves its outline, for sixteen rows.
pub(super) struct WristCrossings<S: Simd> {
    /// Rows in which the wrist is never outside.
    pub all: Mask<S>,
    /// Rows with the elbow inside: the arc may be longer than half a turn.
    pub around: Mask<S>,
    /// Rows with one arc, or with several arcs that are all between these points.
    pub hit: Mask<S>,
    pub lo: Points<S>,
    pub hi: Points<S>,
    /// Rows with several arcs.
    pub several: Mask<S>,
}

/// The line that the wrist crosses, sixteen rows.
#[derive(Clone, Copy)]
struct CrossedLine<S: Simd> {
    normal: Points<S>,
    far: Lanes<S>,
}

impl<S: Simd> CrossedLine<S> {
    #[inline(always)]
    fn set(&mut self, rows: Mask<S>, [x, y, far]: [Lanes<S>; 3]) {
        self.normal = [rows.select(x, self.normal[0]), rows.select(y, self.normal[1])];
        self.far = rows.select(far, self.far);
    }

    /// The intersection of circle and line, relative to the elbow; `side` is 1 at the line's far end, −1 at its near
    /// end.
    #[inline(always)]
    fn point(&self, simd: S, elbow: Points<S>, length: f32, side: f32) -> Points<S> {
        let [x, y] = self.normal;
        let gap = self.far - mad(x, elbow[0], y * elbow[1]);
        let square = splat(simd, length * length) - gap * gap;
        let half = square.max(splat(simd, 0.0)).sqrt() * splat(simd, side);
        [gap * x - half * y, mad(gap, y, half * x)]
    }
}

#[inline(always)]
fn line<S: Simd>(simd: S, normals: &OutlineNormals, outline: &Outline, k: usize) -> [Lanes<S>; 3] {
    [splat(simd, normals.x[k]), splat(simd, normals.y[k]), splat(simd, outline.far[k])]
}

/// Distance from a line's corner up to which the foot of a perpendicular counts as between the corners, metres.
const CORNER_TOLERANCE_M: f32 = 1e-5;

impl<S: Simd> WristCrossings<S> {
    #[inline(always)]
    pub fn new(simd: S, context: &ConvexContext, outlines: &Outlines, culling: &RowCulling, elbow: Points<S>) -> Self {
        let (normals, outline) = (&outlines.normals, &outlines.wrist);
        let s = |value: f32| splat(simd, value);
        let (none, zero) = (Mask::splat(simd, false), s(0.0));
        let length = context.arm.fore_length_m as f32;
        let (mixed, edges) = culling.crossing_edges();
        let tests = CornerTests { outlines, mixed, certain: culling.reached, elbow };
        let empty = CrossedLine { normal: [zero; 2], far: zero };
        let (mut entered, mut left) = (empty, empty);
        let (mut hit, mut several) = (none, none);
        let mut last = (usize::MAX, none);
        for k in ones(edges) {
            let before = if k == last.0 { last.1 } else { tests.is_reached(simd, k) };
            let after = tests.is_reached(simd, tests.next(k));
            last = (k + 1, after);
            // Where the outline leaves the disk, the circle enters the outline.
            let enters = before & !after;
            several |= hit & enters;
            hit |= enters;
            let line = line(simd, normals, outline, k);
            entered.set(enters, line);
            left.set(after & !before, line);
        }
        let mut twice = none;
        for k in ones(culling.double_entry) {
            let [gap, along] = Self::foot(simd, outlines, k, elbow);
            let near = gap.simd_lt(zero) & gap.simd_ge(s(-length));
            let unreached = !tests.is_reached(simd, k) & !tests.is_reached(simd, tests.next(k));
            let here = near & Self::is_between_corners(simd, outline, k, along) & unreached;
            let line = line(simd, normals, outline, k);
            entered.set(here, line);
            left.set(here, line);
            twice |= here;
        }
        (hit, several) = (hit | twice, several & !twice);
        let lo = entered.point(simd, elbow, length, 1.0);
        let hi = left.point(simd, elbow, length, -1.0);
        let mut wrist = Self { all: none, around: none, hit, lo, hi, several };
        if culling.wrist_front == 0 {
            let least = Self::distance_inside(simd, outlines, elbow);
            wrist.all = least.simd_ge(s(length));
            wrist.around = least.simd_ge(zero);
            // From inside, the circle may leave the outline and enter it again through one line.
            for k in ones(culling.double_exit) {
                let [gap, along] = Self::foot(simd, outlines, k, elbow);
                let unreached = !tests.is_reached(simd, k) & !tests.is_reached(simd, tests.next(k));
                let out = Self::is_between_corners(simd, outline, k, along) & gap.simd_lt(s(length)) & unreached;
                wrist.several |= out & wrist.around & !wrist.all;
            }
        }
        // From outside, an arc spans less than half a turn.
        let backwards = (lo[0] * hi[1] - lo[1] * hi[0]).simd_le(zero);
        wrist.several |= hit & !wrist.around & !twice & backwards;
        wrist.hit = hit & !wrist.several;
        wrist
    }

    /// Foot of the perpendicular from the elbow to line `k`: its distance, and its position along the line.
    #[inline(always)]
    fn foot(simd: S, outlines: &Outlines, k: usize, elbow: Points<S>) -> [Lanes<S>; 2] {
        let [x, y, far] = line(simd, &outlines.normals, &outlines.wrist, k);
        [far - mad(x, elbow[0], y * elbow[1]), x * elbow[1] - y * elbow[0]]
    }

    #[inline(always)]
    fn is_between_corners(simd: S, outline: &Outline, k: usize, along: Lanes<S>) -> Mask<S> {
        let s = |value: f32| splat(simd, value);
        s(outline.from[k] - CORNER_TOLERANCE_M).simd_le(along) & along.simd_le(s(outline.to[k] + CORNER_TOLERANCE_M))
    }

    /// Least distance of the elbow from a line, metres; below 0 outside the outline.
    #[inline(always)]
    fn distance_inside(simd: S, outlines: &Outlines, elbow: Points<S>) -> Lanes<S> {
        let (normals, outline) = (&outlines.normals, &outlines.wrist);
        let mut least = splat(simd, f32::INFINITY);
        for k in 0..normals.count {
            let s = |list: &[f32]| splat(simd, list[k]);
            least = least.min(s(&outline.far) - mad(s(&normals.x), elbow[0], s(&normals.y) * elbow[1]));
        }
        least
    }
}
