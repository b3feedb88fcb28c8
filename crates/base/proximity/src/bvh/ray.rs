//! Boxes that a ray passes through.

use elbowroom_spatial::Vec3;
use fearless_simd::{Simd, dispatch, prelude::*};

use super::bvh16::Bvh16;
use super::node::{ARITY, Node};
use super::node_bound::NodeBound;
use crate::lanes::{F32_ERROR, W16, array16, detected_simd_level, load16, narrow, splat16};

/// A ray. The bound is below 0 for boxes that it passes through and above 0 for others.
pub(crate) struct Ray {
    from: [f32; 3],
    inverse: [f32; 3],
}

impl Ray {
    /// Creates a ray from a point of the mesh's box along `direction`; no coordinate of `direction` is 0.
    pub fn new(tree: &Bvh16, from: Vec3, direction: Vec3) -> Self {
        let inverse = Vec3::new(1.0 / direction.x, 1.0 / direction.y, 1.0 / direction.z);
        Self { from: narrow(tree.frame.to_units(from)), inverse: narrow(inverse) }
    }

    #[inline(always)]
    fn lanes<S: Simd>(&self, simd: S, node: &Node) -> W16<S> {
        let c = load16(simd, &node.center).minus(splat16(simd, self.from));
        let h = load16(simd, &node.half).plus(splat16(simd, [(8.0 * F32_ERROR) as f32; 3]));
        let [x, y, z] = self.inverse;
        let (near, far) = (c.minus(h), c.plus(h));
        let (nx, fx) = ((near.0 * x).min(far.0 * x), (near.0 * x).max(far.0 * x));
        let (ny, fy) = ((near.1 * y).min(far.1 * y), (near.1 * y).max(far.1 * y));
        let (nz, fz) = ((near.2 * z).min(far.2 * z), (near.2 * z).max(far.2 * z));
        let enters = nx.max(ny).max(nz).max(0.0);
        // The boxes are inflated by far more than the error of these few roundings.
        enters - fx.min(fy).min(fz)
    }
}

impl NodeBound for Ray {
    fn lower_bounds(&self, node: &Node) -> [f32; ARITY] {
        dispatch!(detected_simd_level(), simd => array16(self.lanes(simd, node)))
    }
}
