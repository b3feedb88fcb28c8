//! The values of one joint in the lanes of a block, evenly spaced.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use fearless_simd::{Simd, f32x16};

use crate::lanes::{Fused, LANES, Row, splat};

/// Number of intervals between the lanes of a block.
pub(crate) const INTERVALS: usize = LANES - 1;
/// Positions of the lanes as fractions of a stretch.
const SHARES: Row = {
    let mut shares = [0.0; LANES];
    let mut lane = 0;
    while lane < LANES {
        shares[lane] = lane as f32 / INTERVALS as f32;
        lane += 1;
    }
    Row(shares)
};

/// The first value of a joint in a stretch, and its change.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct JointStretch {
    pub first: f32,
    pub change: f32,
}

impl JointStretch {
    /// The values in the lanes.
    #[inline(always)]
    pub fn values<S: Simd>(self, simd: S) -> f32x16<S> {
        SHARES.load(simd).fused(splat(simd, self.change), splat(simd, self.first))
    }
}
