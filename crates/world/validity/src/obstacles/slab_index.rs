//! Broad phase for up to a few thousand boxes.
//!
//! Each axis is divided into slabs. Each slab has one bit per box that begins before the slab's end, and one bit per box
//! that ends after the slab's begin. The ends of a query select six sets; the boxes that overlap the query are in all of
//! them.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use fearless_simd::{Simd, f32x4, i32x4, prelude::*};

use super::box_tree::Bounds;

/// Number of slabs per axis.
const SLABS: usize = 128;
/// Index of the last slab, for lanes.
const LAST: f32 = (SLABS - 1) as f32;
/// Number of words that are read together.
const WORDS: usize = 4;
/// Number of boxes in these words.
const BOXES: usize = 64 * WORDS;

/// One bit per box.
type Set = [u64; WORDS];

/// Boxes that do not move.
#[derive(Debug, Clone)]
pub(crate) struct SlabIndex {
    /// Per axis: start of the first slab (m), and number of slabs per metre.
    low: [f32; 4],
    per_metre: [f32; 4],
    /// Sets per 256 boxes, axis, side and slab.
    sets: Vec<Set>,
}

impl SlabIndex {
    /// Builds the index of boxes. Most queries are within `reach_m` of the origin.
    pub fn new(boxes: &[Bounds], reach_m: f32) -> Self {
        let sets = vec![[0; WORDS]; boxes.len().div_ceil(BOXES) * 6 * SLABS];
        let mut index = Self { low: [0.0; 4], per_metre: [0.0; 4], sets };
        for k in 0..3 {
            let low = boxes.iter().map(|b| b.min[k]).fold(f32::INFINITY, f32::min).clamp(-reach_m, reach_m);
            let high = boxes.iter().map(|b| b.max[k]).fold(f32::NEG_INFINITY, f32::max).clamp(-reach_m, reach_m);
            index.low[k] = low;
            index.per_metre[k] = SLABS as f32 / (high - low).max(1e-3);
        }
        for (i, b) in boxes.iter().enumerate() {
            for k in 0..3 {
                index.mark(i, 2 * k, index.slab(b.min[k], k));
                index.mark(i, 2 * k + 1, index.slab(b.max[k], k));
            }
        }
        index.accumulate();
        index
    }

    fn mark(&mut self, item: usize, side: usize, slab: usize) {
        self.sets[(item / BOXES * 6 + side) * SLABS + slab][item % BOXES / 64] |= 1 << (item % 64);
    }

    /// Completes the sets.
    ///
    /// A box that begins in a slab has begun in all later ones. A box that ends in a slab has not ended in earlier ones.
    fn accumulate(&mut self) {
        for (side, sets) in self.sets.chunks_exact_mut(SLABS).enumerate() {
            if side % 2 == 1 {
                sets.reverse();
            }
            for slab in 1..SLABS {
                let before = sets[slab - 1];
                sets[slab].iter_mut().zip(before).for_each(|(word, b)| *word |= b);
            }
            if side % 2 == 1 {
                sets.reverse();
            }
        }
    }

    /// The slab of a coordinate; never decreases as the coordinate increases.
    fn slab(&self, v: f32, k: usize) -> usize {
        ((v - self.low[k]) * self.per_metre[k]).clamp(0.0, LAST) as usize
    }

    /// The slabs of three coordinates.
    #[inline(always)]
    fn slabs<S: Simd>(&self, simd: S, v: f32x4<S>) -> [usize; 3] {
        let slab = (v - f32x4::simd_from(simd, self.low)) * f32x4::simd_from(simd, self.per_metre);
        let slab: i32x4<S> = slab.max(f32x4::splat(simd, 0.0)).min(f32x4::splat(simd, LAST)).to_int();
        let slab: [i32; 4] = slab.into();
        [slab[0] as usize % SLABS, slab[1] as usize % SLABS, slab[2] as usize % SLABS]
    }

    /// Collects the boxes that may overlap the box of a sphere.
    #[inline(always)]
    pub fn near_sphere<S: Simd>(&self, simd: S, [x, y, z]: [f32; 3], radius: f32, found: &mut Vec<u32>) {
        found.clear();
        let (centre, radius) = (f32x4::simd_from(simd, [x, y, z, 0.0]), f32x4::splat(simd, radius));
        let (begins, ends) = (self.slabs(simd, centre + radius), self.slabs(simd, centre - radius));
        for (block, sets) in self.sets.chunks_exact(6 * SLABS).enumerate() {
            let mut all = [u64::MAX; WORDS];
            for k in 0..3 {
                let (begin, end) = (&sets[2 * k * SLABS + begins[k]], &sets[(2 * k + 1) * SLABS + ends[k]]);
                for w in 0..WORDS {
                    all[w] &= begin[w] & end[w];
                }
            }
            for (w, mut bits) in all.into_iter().enumerate() {
                while bits != 0 {
                    found.push((block * BOXES + w * 64) as u32 + bits.trailing_zeros());
                    bits &= bits - 1;
                }
            }
        }
    }
}
