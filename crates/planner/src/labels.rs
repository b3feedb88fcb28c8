//! Which nodes are joined at all: 'no path' is answered before anything is searched.

use crate::graph::{Graph, Node};

/// One number per connected whole (union-find); made anew, when asked, after cells changed.
#[derive(Debug, Default)]
pub(crate) struct Labels {
    above: Vec<Node>,
    fresh: bool,
}

impl Labels {
    /// Cells changed.
    pub fn forget(&mut self) {
        self.fresh = false;
    }

    /// True where no cell has changed since they were made.
    pub fn are_fresh(&self) -> bool {
        self.fresh
    }

    /// The number of a node's connected whole.
    pub fn of(&mut self, graph: &Graph, node: Node) -> Node {
        if !self.fresh {
            self.rebuild(graph);
        }
        self.root(node)
    }

    /// True where a way leads from one node to the other.
    pub fn joined(&mut self, graph: &Graph, a: Node, b: Node) -> bool {
        self.of(graph, a) == self.of(graph, b)
    }

    fn rebuild(&mut self, graph: &Graph) {
        self.above.clear();
        self.above.extend(0..graph.bound() as Node);
        for node in graph.nodes() {
            graph.neighbours(node, &[(0, true), (1, true), (2, true)], |other| self.join(node, other));
        }
        self.fresh = true;
    }

    fn root(&mut self, mut node: Node) -> Node {
        while self.above[node as usize] != node {
            let up = self.above[self.above[node as usize] as usize];
            self.above[node as usize] = up;
            node = up;
        }
        node
    }

    fn join(&mut self, a: Node, b: Node) {
        let (a, b) = (self.root(a), self.root(b));
        // The smaller number is the root, whatever the order.
        self.above[a.max(b) as usize] = a.min(b);
    }

    /// Bytes on the heap.
    pub fn bytes(&self) -> usize {
        self.above.capacity() * size_of::<Node>()
    }
}
