//! The broad phase: boxes that may overlap a query.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use fearless_simd::Simd;

use super::box_tree::{Bounds, BoxTree};
use super::slab_index::SlabIndex;
use crate::lanes::V3;

/// Largest number of boxes that are also stored in slabs.
const MOST_IN_SLABS: usize = 2048;

/// Boxes that do not move: in a tree (faster for a large query) and in slabs (faster for a small query).
#[derive(Debug, Clone, Default)]
pub(crate) struct BroadPhase {
    tree: BoxTree,
    slabs: Option<SlabIndex>,
}

impl BroadPhase {
    /// Builds the index of boxes. Most queries are within `reach_m` of the origin.
    pub fn new(boxes: &[Bounds], reach_m: f32) -> Self {
        let slabs = (boxes.len() <= MOST_IN_SLABS).then(|| SlabIndex::new(boxes, reach_m));
        Self { tree: BoxTree::new(boxes), slabs }
    }

    /// Collects the items whose boxes may overlap the box around the points of a block, enlarged by `margin` (m).
    ///
    /// `open` is workspace.
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

    /// Collects the items whose boxes may overlap the box of one sphere.
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
