//! Traversal of two trees down to the pairs of leaves that may be within a cutoff.

use super::mesh_pair::MeshPair;
use super::node_pair::{NodePair, NodePairStack};
use super::workspace::QueryStats;

/// Calls `visit` with each pair of leaves that may be near until it returns true, and returns whether it did.
///
/// `expand` pushes the pairs of children that may be near and returns the number of box tests; `keep` returns false for pairs
/// of nodes and leaves that need no visit.
#[inline(always)]
pub(super) fn visit_leaf_pairs(
    meshes: &MeshPair,
    expand: impl Fn(&NodePair, &mut NodePairStack) -> u32,
    stack: &mut NodePairStack,
    stats: &mut QueryStats,
    keep: impl Fn(&NodePair) -> bool,
    mut visit: impl FnMut(&NodePair, &mut QueryStats) -> bool,
) -> bool {
    stack.clear();
    stack.push(NodePair::root(&meshes.a.bvh, &meshes.b.bvh));
    while let Some(pair) = stack.pop() {
        if !keep(&pair) {
            continue;
        }
        if pair.is_leaves() {
            stats.leaves += 1;
            if visit(&pair, stats) {
                return true;
            }
        } else {
            stats.nodes += 1;
            stats.boxes += expand(&pair, stack);
        }
    }
    false
}
