//! The forearm and its outline, sixteen rows at a time.
//!
//! Seen from the elbow, the directions in which the forearm touches begin and end at a tangent to its outline, if the
//! touched corner is within reach, or where the end of the forearm crosses the outline. The end carries the wrist's
//! sphere, whose outline contains the forearm's outline: there the wrist is also blocked. Therefore the forearm needs
//! only its tangents, and the wrist only the two points at which its circle enters and leaves its outline.
//!
//! Forearm and wrist together are blocked in one interval. The reason: the forearm's outline is convex, and every arc
//! of the wrist contains an angle at which the forearm touches, or the wrist has only one arc (the part of the disk
//! near a convex outline is convex).

use elbowroom_validity::lanes::simd::{Select, Simd, SimdBase, SimdMask};

use super::context::{ConvexContext, Outlines};
use super::corner_tests::{CornerTests, Mask, Points};
use super::row_culling::RowCulling;
use super::simd_math::{Lanes, mad, splat};
use crate::bits::ones;

/// Tangents from sixteen elbows to the forearm's outline.
pub(super) struct ForearmTangents<S: Simd> {
    /// Whether the elbow is inside, or so close that single precision cannot decide.
    pub inside: Mask<S>,
    /// Corners at which the outline begins (`lo`) and ends (`hi`), counter-clockwise, relative to the elbow.
    pub lo: Points<S>,
    pub hi: Points<S>,
    /// Whether these corners are within reach.
    pub lo_reached: Mask<S>,
    pub hi_reached: Mask<S>,
    /// Bound of the rotation of the tangents by rounding, radians.
    pub widen: Lanes<S>,
}

impl<S: Simd> ForearmTangents<S> {
    #[inline(always)]
    pub fn new(simd: S, context: &ConvexContext, outlines: &Outlines, culling: &RowCulling, elbow: Points<S>) -> Self {
        let (normals, outline) = (&outlines.normals, &outlines.fore);
        let s = |value: f32| splat(simd, value);
        let (none, all, zero) = (Mask::splat(simd, false), Mask::splat(simd, true), s(0.0));
        let never =
            Self { inside: none, lo: [zero; 2], hi: [zero; 2], lo_reached: none, hi_reached: none, widen: zero };
        if !outline.exists {
            return never;
        }
        let (mixed, edges) = culling.front_edges();
        let tests = CornerTests { outlines, mixed, certain: culling.front, elbow };
        let (mut lo, mut hi) = ([zero; 2], [zero; 2]);
        let mut outside = if culling.front.bits == 0 { none } else { all };
        let mut last = (usize::MAX, none);
        for k in ones(edges) {
            let previous = if k == 0 { normals.count } else { k } - 1;
            let before = if k == last.0 { last.1 } else { tests.is_outside(simd, previous) };
            let here = tests.is_outside(simd, k);
            last = (k + 1, here);
            outside |= here;
            // Lines with the elbow outside run clockwise: the first of them begins at the far end.
            let (begins, ends) = (here & !before, before & !here);
            let [x, y] = [s(outline.corner_x[k]), s(outline.corner_y[k])];
            hi = [begins.select(x, hi[0]), begins.select(y, hi[1])];
            lo = [ends.select(x, lo[0]), ends.select(y, lo[1])];
        }
        let (lo, hi) = ([lo[0] - elbow[0], lo[1] - elbow[1]], [hi[0] - elbow[0], hi[1] - elbow[1]]);
        let reach = context.arm.fore_length_m as f32 + context.margin;
        let square = s(reach * reach);
        let lo_reached = mad(lo[0], lo[0], lo[1] * lo[1]).simd_le(square);
        let hi_reached = mad(hi[0], hi[0], hi[1] * hi[1]).simd_le(square);
        let (mut inside, mut widen) = (!outside, zero);
        if culling.clear == 0 {
            let depth = Self::distance_outside(simd, outlines, culling, elbow);
            inside |= depth.simd_lt(s(2.0 * context.margin));
            let close = depth.simd_lt(s(context.clear));
            widen = close.select(s(context.rounding) / depth.max(s(context.margin)), zero);
        }
        Self { inside, lo, hi, lo_reached, hi_reached, widen }
    }

    /// Distance of the elbow from the outline's farthest line, metres; below 0 inside the outline.
    #[inline(always)]
    fn distance_outside(simd: S, outlines: &Outlines, culling: &RowCulling, elbow: Points<S>) -> Lanes<S> {
        let (normals, outline) = (&outlines.normals, &outlines.fore);
        let mut most = splat(simd, f32::NEG_INFINITY);
        for k in ones(culling.may_front.bits) {
            let s = |list: &[f32]| splat(simd, list[k]);
            most = most.max(mad(s(&normals.x), elbow[0], s(&normals.y) * elbow[1]) - s(&outline.far));
        }
        most
    }
}
