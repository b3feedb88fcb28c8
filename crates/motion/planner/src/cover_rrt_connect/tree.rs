//! A tree of configurations with a nearest-neighbour search over all nodes, in single precision.

use super::node_packs::NodePacks;
use crate::rrt_connect::length;

/// A tree of configurations.
#[derive(Debug)]
pub(super) struct Tree {
    dof: usize,
    /// The configurations, one after the other.
    q: Vec<f64>,
    packs: NodePacks,
    /// Number of roots, which are the first nodes.
    roots: usize,
    /// A root is its own parent.
    parents: Vec<u32>,
    /// Length of the branch from the root, rad (and m).
    costs: Vec<f64>,
    /// Per node, the radius of its dynamic domain: the node is not extended to samples that are farther away.
    pub radii: Vec<f32>,
}

impl Tree {
    /// Creates a tree with one or several roots, all with the same number of values.
    pub fn new<'q>(dof: usize, roots: impl IntoIterator<Item = &'q [f64]>) -> Self {
        let (q, parents, costs, radii) = Default::default();
        let mut tree = Self { dof, q, packs: NodePacks::new(dof), roots: 0, parents, costs, radii };
        for root in roots {
            tree.push(tree.len(), 0.0, root);
        }
        tree.roots = tree.len();
        tree
    }

    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// Number of roots, which are the first nodes.
    pub fn roots(&self) -> usize {
        self.roots
    }

    pub fn q(&self, node: usize) -> &[f64] {
        &self.q[node * self.dof..(node + 1) * self.dof]
    }

    /// Adds a node; returns its index.
    pub fn add(&mut self, parent: usize, q: &[f64]) -> usize {
        let cost = self.costs[parent] + length(self.q(parent), q);
        self.push(parent, cost, q)
    }

    /// Length of the branch from the root to a node, rad (and m).
    pub fn cost(&self, node: usize) -> f64 {
        self.costs[node]
    }

    fn push(&mut self, parent: usize, cost: f64, q: &[f64]) -> usize {
        let node = self.len();
        self.packs.push(q);
        self.q.extend_from_slice(q);
        self.parents.push(parent as u32);
        self.costs.push(cost);
        self.radii.push(f32::INFINITY);
        node
    }

    /// The nearest node and its Euclidean distance.
    pub fn nearest(&self, q: &[f64]) -> (usize, f64) {
        let node = self.packs.nearest(q);
        (node, length(self.q(node), q))
    }

    /// The nearest node that reaches a configuration within a cost (including the length of the branch), and its
    /// Euclidean distance.
    pub fn nearest_within(&self, q: &[f64], cost: f64) -> Option<(usize, f64)> {
        let mut best: Option<(usize, f32)> = None;
        for (node, square) in self.packs.squared_distances(q).enumerate() {
            let is_nearer = best.is_none_or(|(_, least)| square < least);
            if is_nearer && self.costs[node] + f64::from(square.sqrt()) <= cost {
                best = Some((node, square));
            }
        }
        best.map(|(node, _)| (node, length(self.q(node), q)))
    }

    /// The nodes from `node` to the root.
    pub fn branch(&self, node: usize) -> Vec<usize> {
        let mut branch = vec![node];
        let mut at = node;
        while self.parents[at] as usize != at {
            at = self.parents[at] as usize;
            branch.push(at);
        }
        branch
    }
}
