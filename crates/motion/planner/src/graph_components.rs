//! Connected components of the coarse graph: missing paths are reported without a search.

use crate::cell_blocks::UPPER_FACES;
use crate::cell_group_graph::{CellGroupGraph, Node};

/// One number per connected component (union-find), computed on demand after cells changed.
#[derive(Debug, Default)]
pub(crate) struct GraphComponents {
    parent: Vec<Node>,
    valid: bool,
}

impl GraphComponents {
    /// Cells changed.
    pub fn invalidate(&mut self) {
        self.valid = false;
    }

    /// True if no cell has changed since the components were computed.
    pub fn are_valid(&self) -> bool {
        self.valid
    }

    /// The component of a node.
    pub fn component_of(&mut self, graph: &CellGroupGraph, node: Node) -> Node {
        if !self.valid {
            self.rebuild(graph);
        }
        self.root(node)
    }

    /// True if two nodes are connected.
    pub fn connected(&mut self, graph: &CellGroupGraph, a: Node, b: Node) -> bool {
        self.component_of(graph, a) == self.component_of(graph, b)
    }

    fn rebuild(&mut self, graph: &CellGroupGraph) {
        self.parent.clear();
        self.parent.extend(0..graph.node_bound() as Node);
        for node in graph.nodes() {
            graph.neighbours(node, &UPPER_FACES, |other| self.unite(node, other));
        }
        self.valid = true;
    }

    fn root(&mut self, mut node: Node) -> Node {
        while self.parent[node as usize] != node {
            let grandparent = self.parent[self.parent[node as usize] as usize];
            self.parent[node as usize] = grandparent;
            node = grandparent;
        }
        node
    }

    fn unite(&mut self, a: Node, b: Node) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller number is the root, independent of the order.
        self.parent[a.max(b) as usize] = a.min(b);
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.parent.capacity() * size_of::<Node>()
    }
}
