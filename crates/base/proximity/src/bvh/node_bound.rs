//! The interface of single-tree traversals.

use super::node::{ARITY, Node};

/// A lower bound of some quantity (distance, height, ray parameter) for the sixteen children of a node. The smaller the
/// bound, the earlier a child is visited.
pub(crate) trait NodeBound {
    /// Bounds of the children of a node, in units of the tree's frame.
    fn lower_bounds(&self, node: &Node) -> [f32; ARITY];
}
