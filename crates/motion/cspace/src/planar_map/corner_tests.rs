//! Tests of single lines and corners for the elbows of sixteen rows.

use elbowroom_validity::lanes::simd::{Simd, SimdBase, SimdMask, mask32x16};

use super::context::Outlines;
use super::row_culling::LineBits;
use super::simd_math::{Lanes, mad, splat};

pub(super) type Mask<S> = mask32x16<S>;

/// Sixteen points, x and y.
pub(super) type Points<S> = [Lanes<S>; 2];

/// One result per line or corner and per row of sixteen: most results are known from the culling.
#[derive(Clone, Copy)]
pub(super) struct CornerTests<'a, S: Simd> {
    pub outlines: &'a Outlines,
    /// Lines or corners whose results differ between rows.
    pub mixed: LineBits,
    /// Results of the other lines or corners.
    pub certain: LineBits,
    pub elbow: Points<S>,
}

impl<S: Simd> CornerTests<'_, S> {
    /// Whether the elbow is outside line `k` of the forearm's outline.
    #[inline(always)]
    pub fn is_outside(&self, simd: S, k: usize) -> Mask<S> {
        let Outlines { normals, fore, .. } = self.outlines;
        if self.mixed.contains(k) {
            let [x, y, far] = [splat(simd, normals.x[k]), splat(simd, normals.y[k]), splat(simd, fore.far[k])];
            return far.simd_lt(mad(x, self.elbow[0], y * self.elbow[1]));
        }
        Mask::splat(simd, self.certain.contains(k))
    }

    /// Whether corner `k` of the wrist's outline is within reach of the forearm.
    #[inline(always)]
    pub fn is_reached(&self, simd: S, k: usize) -> Mask<S> {
        let Outlines { wrist, reach_limits, .. } = self.outlines;
        if self.mixed.contains(k) {
            let [x, y, from] =
                [splat(simd, wrist.corner_x[k]), splat(simd, wrist.corner_y[k]), splat(simd, reach_limits[k])];
            return from.simd_le(mad(x, self.elbow[0], y * self.elbow[1]));
        }
        Mask::splat(simd, self.certain.contains(k))
    }

    pub fn next(&self, k: usize) -> usize {
        if k + 1 == self.outlines.normals.count { 0 } else { k + 1 }
    }
}
