//! RRT-Connect (Kuffner, `LaValle`: *RRT-Connect: an efficient approach to single-query path planning*, 2000) with a dynamic
//! domain (Yershova, Jaillet, Siméon, `LaValle`: *Dynamic-domain RRTs*, 2005): a node from which an extension failed is extended
//! only towards nearby samples. Proofs are lazy: edges of a path are proven when the trees meet; an edge that cannot be
//! proven is pruned with its subtree, and the search continues.

use super::motion_validator::MotionValidator;
use super::tree::Tree;
use crate::interpolation::{length, lerp};

/// Dynamic domain of a node after its first failure, rad (and m).
const DOMAIN_RADIUS: f64 = 4.0;

/// Smallest gain of a step of a connection, as a fraction of the distance to its target; a step with less gain is the
/// last.
pub(crate) const LEAST_PROGRESS: f64 = 0.05;

/// Draws configurations.
pub(crate) trait ConfigurationSampler {
    /// A configuration for a tree to grow towards; one of its roots is `root`.
    fn sample(&mut self, root: &[f64], out: &mut [f64]);
}

/// Two trees that grow towards each other.
pub(crate) struct TreeSearch<'v, V> {
    pub validator: &'v mut V,
    trees: [Tree; 2],
    /// Whether the first tree belongs to the goal.
    is_swapped: bool,
}

impl<'v, V: MotionValidator> TreeSearch<'v, V> {
    /// Creates a search from a start to any of several goals.
    pub fn new<'q>(validator: &'v mut V, start: &'q [f64], goals: impl IntoIterator<Item = &'q [f64]>) -> Self {
        let trees = [Tree::new(start.len(), [start]), Tree::new(start.len(), goals)];
        Self { validator, trees, is_swapped: false }
    }

    /// Number of nodes in both trees.
    pub fn nodes(&self) -> usize {
        self.trees.iter().map(Tree::len).sum()
    }

    /// Searches for a path. Returns its waypoints; `None` if a limit is reached.
    pub fn run(&mut self, sampler: &mut impl ConfigurationSampler) -> Option<Vec<Vec<f64>>> {
        let mut sample = self.trees[0].q(0).to_vec();
        let mut round = 0;
        while !self.validator.is_exhausted() {
            if self.trees[0].len() > self.trees[1].len() {
                self.trees.swap(0, 1);
                self.is_swapped = !self.is_swapped;
            }
            sampler.sample(self.trees[0].q(round % self.trees[0].roots()), &mut sample);
            round += 1;
            let (near, distance) = self.trees[0].nearest(&sample);
            if distance == 0.0 || f64::from(self.trees[0].radii[near]) < distance {
                continue;
            }
            let Some(node) = self.extend(0, near, &sample, distance) else { continue };
            if let Some(other) = self.connect(node)
                && self.is_proven(node, other)
            {
                return Some(self.path(node, other));
            }
        }
        None
    }

    /// Adds one edge towards a target. Returns the new node.
    fn extend(&mut self, tree: usize, near: usize, target: &[f64], distance: f64) -> Option<usize> {
        let mut next = target.to_vec();
        let from = &self.trees[tree];
        let longest = self.validator.longest_edge();
        if distance > longest {
            lerp(from.q(near), target, longest / distance, &mut next);
        }
        if !self.validator.project(&mut next) || !self.validator.motion_is_free(from.q(near), &next) {
            let radius = &mut self.trees[tree].radii[near];
            *radius = radius.min(DOMAIN_RADIUS as f32) * 0.999_9;
            if !radius.is_finite() {
                *radius = DOMAIN_RADIUS as f32;
            }
            return None;
        }
        Some(self.trees[tree].add(near, &next))
    }

    /// Grows the second tree straight to a node of the first. Returns the node that reaches it.
    fn connect(&mut self, node: usize) -> Option<usize> {
        let target = self.trees[0].q(node).to_vec();
        let (mut near, mut distance) = self.trees[1].nearest(&target);
        while distance > 0.0 && !self.validator.is_exhausted() {
            near = self.extend(1, near, &target, distance)?;
            let left = length(self.trees[1].q(near), &target);
            // A projection may lead elsewhere.
            if left > distance * (1.0 - LEAST_PROGRESS) {
                return None;
            }
            distance = left;
        }
        (distance == 0.0).then_some(near)
    }

    /// Whether the branches to two nodes are proven free.
    fn is_proven(&mut self, node: usize, other: usize) -> bool {
        let [first, second] = &mut self.trees;
        first.prove_branch(node, |from, to| self.validator.proves_motion(from, to))
            && second.prove_branch(other, |from, to| self.validator.proves_motion(from, to))
    }

    fn path(&self, node: usize, other: usize) -> Vec<Vec<f64>> {
        let branch = |tree: usize, node: usize| {
            self.trees[tree].branch(node).into_iter().map(move |n| self.trees[tree].q(n).to_vec())
        };
        let mut path: Vec<Vec<f64>> = branch(0, node).collect();
        path.reverse();
        path.extend(branch(1, other));
        path.dedup();
        if self.is_swapped {
            path.reverse();
        }
        path
    }
}
