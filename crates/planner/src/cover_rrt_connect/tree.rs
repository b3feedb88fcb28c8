//! A tree of configurations with a nearest-neighbour search over all nodes, in single precision.

use crate::rrt_connect::length;

/// Nodes whose coordinates are together in memory.
const LANES: usize = 16;

/// A tree of configurations.
#[derive(Debug)]
pub(super) struct Tree {
    dof: usize,
    /// The configurations, one after the other.
    q: Vec<f64>,
    /// Per sixteen nodes, the values of each joint; unused nodes are far away.
    packs: Vec<Vec<[f32; LANES]>>,
    /// A root is its own parent.
    parents: Vec<u32>,
    /// Length of the branch from the root, rad (and m).
    costs: Vec<f64>,
    /// Per node, samples that are farther away are not extended to: its dynamic domain.
    pub radii: Vec<f32>,
}

impl Tree {
    /// A tree with one root or several, all of the same number of values.
    pub fn new<'q>(dof: usize, roots: impl IntoIterator<Item = &'q [f64]>) -> Self {
        let (q, packs, parents, costs, radii) = Default::default();
        let mut tree = Self { dof, q, packs, parents, costs, radii };
        for root in roots {
            tree.push(tree.len(), 0.0, root);
        }
        tree
    }

    pub fn len(&self) -> usize {
        self.parents.len()
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
        if node.is_multiple_of(LANES) {
            self.packs.push(vec![[f32::INFINITY; LANES]; self.dof]);
        }
        if let Some(pack) = self.packs.last_mut() {
            for (row, &v) in pack.iter_mut().zip(q) {
                row[node % LANES] = v as f32;
            }
        }
        self.q.extend_from_slice(q);
        self.parents.push(parent as u32);
        self.costs.push(cost);
        self.radii.push(f32::INFINITY);
        node
    }

    /// The nearest node and its Euclidean distance.
    pub fn nearest(&self, q: &[f64]) -> (usize, f64) {
        let mut best = [f32::INFINITY; LANES];
        let mut best_pack = [0_u32; LANES];
        for (i, pack) in self.packs.iter().enumerate() {
            let squares = squared_distances(pack, q);
            for lane in 0..LANES {
                let is_nearer = squares[lane] < best[lane];
                best[lane] = if is_nearer { squares[lane] } else { best[lane] };
                best_pack[lane] = if is_nearer { i as u32 } else { best_pack[lane] };
            }
        }
        let lane = (0..LANES).fold(0, |least, lane| if best[lane] < best[least] { lane } else { least });
        let node = best_pack[lane] as usize * LANES + lane;
        (node, length(self.q(node), q))
    }

    /// The nearest node from which a configuration is reached at no more than a cost (the branch's length included), and its
    /// Euclidean distance.
    pub fn nearest_within(&self, q: &[f64], cost: f64) -> Option<(usize, f64)> {
        let mut best: Option<(usize, f32)> = None;
        for (i, pack) in self.packs.iter().enumerate() {
            let squares = squared_distances(pack, q);
            for (lane, (&square, &before)) in squares.iter().zip(&self.costs[i * LANES..]).enumerate() {
                let is_nearer = best.is_none_or(|(_, least)| square < least);
                if is_nearer && before + f64::from(square.sqrt()) <= cost {
                    best = Some((i * LANES + lane, square));
                }
            }
        }
        best.map(|(node, _)| (node, length(self.q(node), q)))
    }

    /// The nodes from one to the root.
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

/// Squared distances of sixteen nodes.
fn squared_distances(pack: &[[f32; LANES]], q: &[f64]) -> [f32; LANES] {
    let mut squares = [0.0_f32; LANES];
    for (row, &v) in pack.iter().zip(q) {
        let v = v as f32;
        for (square, &x) in squares.iter_mut().zip(row) {
            *square += (x - v) * (x - v);
        }
    }
    squares
}
