//! Broad phase: a tree of bounding boxes with sixteen children per node, tested one node at a time.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use fearless_simd::{Simd, prelude::*};

use crate::lanes::{LANES, Row, V3, splat};

/// An axis-aligned box in single precision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Bounds {
    pub min: [f32; 3],
    pub max: [f32; 3],
}

impl Bounds {
    pub const EMPTY: Self = Self { min: [f32::INFINITY; 3], max: [f32::NEG_INFINITY; 3] };

    /// The box around the points of all lanes, enlarged by a margin (m).
    #[inline(always)]
    pub fn around<S: Simd>(v: V3<S>, margin: f32) -> Self {
        let min = [v.0.reduce_min() - margin, v.1.reduce_min() - margin, v.2.reduce_min() - margin];
        let max = [v.0.reduce_max() + margin, v.1.reduce_max() + margin, v.2.reduce_max() + margin];
        Self { min, max }
    }

    /// The box around a sphere.
    #[inline(always)]
    pub fn of_sphere(centre: [f32; 3], radius: f32) -> Self {
        let [x, y, z] = centre;
        Self { min: [x - radius, y - radius, z - radius], max: [x + radius, y + radius, z + radius] }
    }

    fn union(&self, o: &Self) -> Self {
        let mut all = *self;
        for k in 0..3 {
            all.min[k] = all.min[k].min(o.min[k]);
            all.max[k] = all.max[k].max(o.max[k]);
        }
        all
    }
}

/// Sixteen boxes.
#[derive(Debug, Clone)]
struct Pack {
    min: [Row; 3],
    max: [Row; 3],
}

/// A tree over boxes that do not move.
#[derive(Debug, Clone, Default)]
pub(crate) struct BoxTree {
    /// Levels of packs: the boxes of items, then the boxes of packs, up to a single pack.
    levels: Vec<Vec<Pack>>,
    /// Item of each box of the lowest level.
    items: Vec<u32>,
}

impl BoxTree {
    pub fn new(boxes: &[Bounds]) -> Self {
        let items = spatial_order(boxes);
        let mut level: Vec<Bounds> = items.iter().map(|&i| boxes[i as usize]).collect();
        let mut levels = Vec::new();
        while !level.is_empty() {
            levels.push(level.chunks(LANES).map(Pack::new).collect());
            if level.len() <= LANES {
                break;
            }
            level = level.chunks(LANES).map(|c| c.iter().fold(Bounds::EMPTY, |all, b| all.union(b))).collect();
        }
        Self { levels, items }
    }

    /// Collects the items whose boxes overlap a box. `open` is workspace for the packs still to visit.
    #[inline(always)]
    pub fn overlapping<S: Simd>(&self, simd: S, bounds: &Bounds, open: &mut Vec<(u32, u32)>, found: &mut Vec<u32>) {
        found.clear();
        open.clear();
        if let Some(top) = self.levels.len().checked_sub(1) {
            open.push((top as u32, 0));
        }
        while let Some((level, pack)) = open.pop() {
            let mut hits = self.levels[level as usize][pack as usize].overlaps(simd, bounds);
            while hits != 0 {
                let child = pack * LANES as u32 + hits.trailing_zeros();
                hits &= hits - 1;
                match level.checked_sub(1) {
                    Some(below) => open.push((below, child)),
                    None => found.push(self.items[child as usize]),
                }
            }
        }
    }
}

impl Pack {
    fn new(boxes: &[Bounds]) -> Self {
        let mut pack = Self { min: [Row([f32::INFINITY; LANES]); 3], max: [Row([f32::NEG_INFINITY; LANES]); 3] };
        for (lane, b) in boxes.iter().enumerate() {
            for k in 0..3 {
                pack.min[k].0[lane] = b.min[k];
                pack.max[k].0[lane] = b.max[k];
            }
        }
        pack
    }

    /// One bit per child whose box overlaps; boxes that only touch count.
    #[inline(always)]
    fn overlaps<S: Simd>(&self, simd: S, b: &Bounds) -> u32 {
        let x = self.overlaps_along(simd, b, 0);
        let y = self.overlaps_along(simd, b, 1);
        let z = self.overlaps_along(simd, b, 2);
        x & y & z
    }

    #[inline(always)]
    fn overlaps_along<S: Simd>(&self, simd: S, b: &Bounds, k: usize) -> u32 {
        let starts_before = self.min[k].load(simd).simd_le(splat(simd, b.max[k]));
        let ends_after = self.max[k].load(simd).simd_ge(splat(simd, b.min[k]));
        (starts_before & ends_after).to_bitmask() as u32
    }
}

/// The items in the order of a curve through space (Morton, 1966), so that neighbours share packs.
fn spatial_order(boxes: &[Bounds]) -> Vec<u32> {
    let all = boxes.iter().fold(Bounds::EMPTY, |all, b| all.union(b));
    let key = |b: &Bounds| {
        let cell = |k: usize| {
            // Unbounded boxes come first or last; either is correct.
            let (low, high) = (all.min[k].max(-1e6), all.max[k].min(1e6));
            let share = (0.5 * (b.min[k].max(-1e6) + b.max[k].min(1e6)) - low) / (high - low).max(1e-6);
            (share.clamp(0.0, 1.0) * 1023.0) as u32
        };
        interleaved(cell(0)) | interleaved(cell(1)) << 1 | interleaved(cell(2)) << 2
    };
    let mut order: Vec<(u32, u32)> = boxes.iter().enumerate().map(|(i, b)| (key(b), i as u32)).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, i)| i).collect()
}

/// Ten bits with two zeros between them.
fn interleaved(v: u32) -> u32 {
    let v = (v | v << 16) & 0x0300_00ff;
    let v = (v | v << 8) & 0x0300_f00f;
    let v = (v | v << 4) & 0x030c_30c3;
    (v | v << 2) & 0x0924_9249
}
