//! Which boxes may overlap a query.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use fearless_simd::Simd;

use super::box_tree::{Bounds, BoxTree};
use super::slab_index::SlabIndex;
use crate::lanes::V3;

/// Up to so many boxes are in slabs, too.
const MOST_IN_SLABS: usize = 2048;

/// Boxes that do not move: a tree, which is faster for a large query, and slabs, which are faster for a small one.
#[derive(Debug, Clone, Default)]
pub(crate) struct BroadPhase {
    tree: BoxTree,
    slabs: Option<SlabIndex>,
}

impl BroadPhase {
    /// Of boxes; queries are within `reach_m` of the origin, mostly.
    pub fn new(boxes: &[Bounds], reach_m: f32) -> Self {
        let slabs = (boxes.len() <= MOST_IN_SLABS).then(|| SlabIndex::new(boxes, reach_m));
        Self { tree: BoxTree::new(boxes), slabs }
    }

    /// Collects the items whose boxes may overlap that around the points of a block, `margin` larger; `open` is memory.
    #[inline(always)]
    pub fn around<S: Simd>(
        &self,
        simd: S,
        points: V3<S>,
        margin: f32,
        open: &mut Vec<(u32, u32)>,
        found: &mut Vec<u32>,
    ) {
        self.tree.overlapping(simd, &Bounds::around(points, margin), open, found);
    }

    /// The same of one sphere.
    #[inline(always)]
    pub fn near_sphere<S: Simd>(
        &self,
        simd: S,
        centre: [f32; 3],
        radius: f32,
        open: &mut Vec<(u32, u32)>,
        found: &mut Vec<u32>,
    ) {
        match &self.slabs {
            Some(slabs) => slabs.near_sphere(simd, centre, radius, found),
            None => self.tree.overlapping(simd, &Bounds::of_sphere(centre, radius), open, found),
        }
    }
}
