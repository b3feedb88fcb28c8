//! Least height along a direction.

use elbowroom_spatial::Vec3;
use fearless_simd::{Simd, dispatch};

use super::bvh16::Bvh16;
use super::node::{ARITY, Node};
use super::node_bound::NodeBound;
use crate::lanes::{F32_ERROR, W16, array16, detected_simd_level, load16, narrow, splat16};

/// Height of boxes along a direction, units of the tree's frame.
pub(crate) struct LeastHeight {
    up: [f32; 3],
}

impl LeastHeight {
    /// Creates the query along `up`, a unit vector in the mesh's frame.
    pub fn new(up: Vec3) -> Self {
        Self { up: narrow(up) }
    }

    /// Converts the height of a point of the mesh to a limit of the traversal.
    pub fn limit(tree: &Bvh16, up: Vec3, p: Vec3) -> f32 {
        (tree.frame.to_units(p).dot(up) + 2.0 * F32_ERROR) as f32
    }

    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S, node: &Node) -> W16<S> {
        let [x, y, z] = self.up;
        let reach = load16(simd, &node.half).dot(splat16(simd, [x.abs(), y.abs(), z.abs()]));
        load16(simd, &node.center).dot(splat16(simd, self.up)) - reach
    }
}

impl NodeBound for LeastHeight {
    fn lower_bounds(&self, node: &Node) -> [f32; ARITY] {
        dispatch!(detected_simd_level(), simd => array16(self.lanes(simd, node)))
    }
}
