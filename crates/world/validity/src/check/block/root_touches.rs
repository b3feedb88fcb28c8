//! Configurations at which the largest spheres of links certainly touch an obstacle.

#![allow(clippy::inline_always, reason = "part of a kernel that is compiled for each instruction set as a whole")]

use fearless_simd::{Simd, prelude::*};

use super::{BlockModel, Workspace};
use crate::lanes::splat;

impl BlockModel<'_> {
    /// Lanes in which a sphere at the root of a link is so deep in an obstacle that a smaller one touches it.
    ///
    /// Ends as soon as `is_enough` of the lanes so far. The values in the lanes must be set.
    #[inline(always)]
    pub fn root_touches<S: Simd>(&self, simd: S, workspace: &mut Workspace, is_enough: impl Fn(u32) -> bool) -> u32 {
        workspace.begin_block();
        self.robot.chain.forward(simd, &workspace.values, &mut workspace.frames);
        let mut touching = 0;
        // Links farthest from the base move most and hit first.
        for (link, covered) in self.robot.covered_links.iter().enumerate().rev().filter(|(_, link)| link.frame != 0) {
            for &root in &covered.broad_phase {
                touching |= self.root_touches_of(simd, workspace, link, root);
                if is_enough(touching) {
                    return touching;
                }
            }
        }
        touching
    }

    #[inline(always)]
    fn root_touches_of<S: Simd>(&self, simd: S, workspace: &mut Workspace, link: usize, root: u32) -> u32 {
        let node = &self.robot.nodes[root as usize];
        let centre = workspace.centre(simd, self.robot, root);
        let mut found = std::mem::take(&mut workspace.found);
        self.tree.around(simd, centre, node.radius, &mut workspace.open, &mut found);
        let mut touching = 0;
        for &obstacle in found.iter().filter(|obstacle| !self.is_skipped(link, **obstacle)) {
            let solid = &self.obstacles.outer[obstacle as usize];
            let length = node.touching_m + solid.radius;
            if length > 0.0 {
                let vector = solid.vector_from_core(simd, centre).vector;
                touching |= vector.dot(vector).simd_lt(splat(simd, length * length)).to_bitmask() as u32;
            }
        }
        workspace.found = found;
        touching
    }
}
