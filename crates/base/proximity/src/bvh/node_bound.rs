//! The interface of single-tree traversals.

use fearless_simd::{Simd, dispatch, prelude::*};

use super::node::{ARITY, LEAF_SIZE, Leaf, Node};
use crate::lanes::{V3, W8, detected_simd_level, load_corners};

/// A lower bound of some quantity (distance, height, ray parameter) for the sixteen children of a node. The smaller the
/// bound, the earlier a child is visited.
pub(crate) trait NodeBound {
    /// Bounds of the children of a node, in units of the tree's frame.
    fn lower_bounds(&self, node: &Node) -> [f32; ARITY];

    /// Bounds of the triangles of a leaf.
    fn leaf_bounds(&self, leaf: &Leaf) -> [f32; LEAF_SIZE] {
        let bounds = self.lower_bounds(&dispatch!(detected_simd_level(), simd => node_of_triangles(simd, leaf)));
        std::array::from_fn(|lane| bounds[lane])
    }
}

/// Normals of triangles, not longer than 1.
#[inline(always)]
pub(super) fn normals<S: Simd>(simd: S, [p, q, r]: [V3<W8<S>>; 3]) -> V3<W8<S>> {
    let n = q.minus(p).cross(r.minus(p));
    n.times(W8::splat(simd, 0.999_999) / n.dot(n).max(1e-30).sqrt())
}

/// The triangles of a leaf as the children of a node.
#[inline(always)]
fn node_of_triangles<S: Simd>(simd: S, leaf: &Leaf) -> Node {
    let [p, q, r] = load_corners(simd, &leaf.corner);
    let n = normals(simd, [p, q, r]);
    let (hp, hq, hr) = (n.dot(p), n.dot(q), n.dot(r));
    let low = V3(p.0.min(q.0).min(r.0), p.1.min(q.1).min(r.1), p.2.min(q.2).min(r.2));
    let high = V3(p.0.max(q.0).max(r.0), p.1.max(q.1).max(r.1), p.2.max(q.2).max(r.2));
    let mut node = Node::EMPTY;
    let middle = W8::splat(simd, 0.5);
    let (center, half) = (low.plus(high).times(middle), high.minus(low).times(middle));
    for (to, from) in [(&mut node.center, center), (&mut node.half, half), (&mut node.normal, n)] {
        from.0.store_slice(&mut to[0][..LEAF_SIZE]);
        from.1.store_slice(&mut to[1][..LEAF_SIZE]);
        from.2.store_slice(&mut to[2][..LEAF_SIZE]);
    }
    hp.min(hq).min(hr).store_slice(&mut node.low[..LEAF_SIZE]);
    hp.max(hq).max(hr).store_slice(&mut node.high[..LEAF_SIZE]);
    node
}
