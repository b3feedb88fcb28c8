//! Connected components of the coarse graph: they show without a search that no path exists.

use crate::cell_blocks::UPPER_FACES;
use crate::cell_group_graph::{CellGroupGraph, Node};

/// The connected component of each node (union-find), computed on demand after cells have changed.
#[derive(Debug, Default)]
pub(crate) struct GraphComponents {
    parent: Vec<Node>,
    valid: bool,
}

impl GraphComponents {
    /// Marks the components as outdated because cells have changed.
    pub fn invalidate(&mut self) {
        self.valid = false;
    }

    /// Whether the components are up to date: no cell has changed since they were computed.
    pub fn are_valid(&self) -> bool {
        self.valid
    }

    /// Returns the component of a node.
    pub fn component_of(&mut self, graph: &CellGroupGraph, node: Node) -> Node {
        if !self.valid {
            self.rebuild(graph);
        }
        self.root(node)
    }

    /// Whether two nodes are connected.
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
        // The smaller index is the root, so that the result does not depend on the order.
        self.parent[a.max(b) as usize] = a.min(b);
    }

    /// Memory on the heap, bytes.
    pub fn bytes(&self) -> usize {
        self.parent.capacity() * size_of::<Node>()
    }
}
