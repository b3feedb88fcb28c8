//! A tree of configurations with a nearest-neighbour search over all nodes, in single precision.

use elbowroom_cspace::NearestNeighbours;

use crate::interpolation::length;

/// A tree of configurations.
#[derive(Debug)]
pub(crate) struct Tree {
    dof: usize,
    /// The configurations, one after the other.
    q: Vec<f64>,
    nodes: NearestNeighbours,
    /// Number of roots, which are the first nodes.
    roots: usize,
    /// A root is its own parent.
    parents: Vec<u32>,
    /// Length of the branch from the root, rad (and m).
    costs: Vec<f64>,
    /// Per node, the radius of its dynamic domain: the node is not extended to samples that are farther away.
    pub radii: Vec<f32>,
    /// Whether the edge to the parent is proven free.
    is_proven: Vec<bool>,
}

impl Tree {
    /// Creates a tree with one or several roots, all with the same number of values.
    pub fn new<'q>(dof: usize, roots: impl IntoIterator<Item = &'q [f64]>) -> Self {
        let (q, parents, costs, radii, is_proven) = Default::default();
        let mut tree = Self { dof, q, nodes: NearestNeighbours::new(dof), roots: 0, parents, costs, radii, is_proven };
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
        self.nodes.push(q);
        self.q.extend_from_slice(q);
        self.parents.push(parent as u32);
        self.costs.push(cost);
        self.radii.push(f32::INFINITY);
        self.is_proven.push(parent == node);
        node
    }

    /// Proves the edges from the root to a node, those near the root first, because they have the largest subtrees. Where
    /// a proof fails, the subtree is pruned: its nodes are never nearest again.
    pub fn prove_branch(&mut self, node: usize, mut proves: impl FnMut(&[f64], &[f64]) -> bool) -> bool {
        for n in self.branch(node).into_iter().rev().filter(|&n| !self.is_proven[n]).collect::<Vec<_>>() {
            if !proves(self.q(self.parents[n] as usize), self.q(n)) {
                self.prune(n);
                return false;
            }
            self.is_proven[n] = true;
        }
        true
    }

    /// Prunes a node and its subtree. Children have greater indices than their parents.
    fn prune(&mut self, node: usize) {
        let mut is_pruned = vec![false; self.len()];
        for n in node..self.len() {
            is_pruned[n] = n == node || is_pruned[self.parents[n] as usize];
            if is_pruned[n] {
                self.nodes.remove(n);
            }
        }
    }

    /// The nearest node and its Euclidean distance.
    pub fn nearest(&self, q: &[f64]) -> (usize, f64) {
        let node = self.nodes.nearest(q);
        (node, length(self.q(node), q))
    }

    /// The nearest node that reaches a configuration within a cost (including the length of the branch), and its
    /// Euclidean distance.
    pub fn nearest_within(&self, q: &[f64], cost: f64) -> Option<(usize, f64)> {
        let mut best: Option<(usize, f32)> = None;
        for (node, square) in self.nodes.squared_distances(q).enumerate() {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_behind_an_edge_that_is_not_proven_are_never_nearest() {
        let mut tree = Tree::new(2, [&[0.0, 0.0][..]]);
        let a = tree.add(0, &[1.0, 0.0]);
        let b = tree.add(a, &[2.0, 0.0]);
        let c = tree.add(0, &[0.0, 5.0]);
        assert_eq!(tree.nearest(&[2.2, 0.0]), (b, length(&[2.2, 0.0], &[2.0, 0.0])));
        assert_eq!(tree.branch(b), [b, a, 0]);
        let mut asked = Vec::new();
        assert!(tree.prove_branch(c, |from, to| {
            asked.push((from.to_vec(), to.to_vec()));
            true
        }));
        assert_eq!(asked, [(vec![0.0, 0.0], vec![0.0, 5.0])]);
        // A proven edge is not proven again.
        assert!(tree.prove_branch(c, |_, _| false));
        assert!(!tree.prove_branch(b, |_, _| false));
        assert_eq!(tree.nearest(&[2.2, 0.0]).0, 0);
        assert_eq!(tree.nearest_within(&[2.2, 4.0], 100.0).unwrap().0, c);
    }
}
