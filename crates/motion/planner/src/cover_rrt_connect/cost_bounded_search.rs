//! RRT-Connect for paths shorter than a bound, in the space of configurations and costs (Wilson, Thomason, Kingston,
//! Gammell: *AORRTC: almost-surely asymptotically optimal planning with RRT-Connect*, 2025): a sample is a
//! configuration and a cost. It is joined to the nearest node that reaches it within this cost.

use super::informed_sampler::InformedSampler;
use crate::interpolation::{length, lerp};
use crate::rrt_connect::{LEAST_PROGRESS, MotionValidator, Tree};

/// Two trees that keep only nodes that may be on a path below a bound.
pub(super) struct CostBoundedSearch<'v, V> {
    pub validator: &'v mut V,
    trees: [Tree; 2],
    /// Ends from which the trees grow: the start, and the goals.
    roots: [Vec<Vec<f64>>; 2],
    bound: f64,
}

impl<'v, V: MotionValidator> CostBoundedSearch<'v, V> {
    /// Creates a search for a path from a start to one of several goals that is shorter than `bound`, rad (and m).
    pub fn new(validator: &'v mut V, start: &[f64], goals: &[Vec<f64>], bound: f64) -> Self {
        let tree = |roots: &[Vec<f64>]| Tree::new(start.len(), roots.iter().map(Vec::as_slice));
        let roots = [vec![start.to_vec()], goals.to_vec()];
        Self { validator, trees: [tree(&roots[0]), tree(&roots[1])], roots, bound }
    }

    /// Searches for a path. Returns the waypoints of a path below the bound; `None` if a limit is reached.
    pub fn run(&mut self, sampler: &mut InformedSampler) -> Option<Vec<Vec<f64>>> {
        let mut sample = self.roots[0][0].clone();
        while !self.validator.is_exhausted() {
            for side in [0, 1] {
                if !sampler.sample(self.bound, &mut sample) {
                    return None;
                }
                let [least, rest] = [side, 1 - side].map(|s| self.distance_from_roots(s, &sample));
                let cost = sampler.between(least, self.bound - rest);
                let Some(node) = self.extend(side, &sample, cost) else { continue };
                if let Some(other) = self.connect(1 - side, side, node) {
                    return Some(self.path(side, node, other));
                }
            }
        }
        None
    }

    fn distance_from_roots(&self, side: usize, q: &[f64]) -> f64 {
        self.roots[side].iter().map(|root| length(root, q)).fold(f64::INFINITY, f64::min)
    }

    /// Adds one edge towards a sample, from the nearest node that reaches it within a cost. Returns the new node.
    fn extend(&mut self, side: usize, sample: &[f64], cost: f64) -> Option<usize> {
        let (near, distance) = self.trees[side].nearest_within(sample, cost)?;
        self.step(side, near, sample, distance)
    }

    fn step(&mut self, side: usize, near: usize, target: &[f64], distance: f64) -> Option<usize> {
        if distance == 0.0 {
            return None;
        }
        let mut next = target.to_vec();
        let from = self.trees[side].q(near);
        let longest = self.validator.longest_edge();
        if distance > longest {
            lerp(from, target, longest / distance, &mut next);
        }
        if !self.validator.project(&mut next) {
            return None;
        }
        let cost = self.trees[side].cost(near) + length(self.trees[side].q(near), &next);
        let may_be_shorter = cost + self.distance_from_roots(1 - side, &next) < self.bound;
        if !may_be_shorter || !self.validator.is_valid_motion(self.trees[side].q(near), &next) {
            return None;
        }
        Some(self.trees[side].add(near, &next))
    }

    /// Extends a tree straight to a node of the other tree. Returns the node that reaches it below the bound.
    fn connect(&mut self, side: usize, other_side: usize, node: usize) -> Option<usize> {
        let target = self.trees[other_side].q(node).to_vec();
        let left = self.bound - self.trees[other_side].cost(node);
        let (mut near, mut distance) = self.trees[side].nearest_within(&target, left)?;
        while distance > 0.0 && !self.validator.is_exhausted() {
            near = self.step(side, near, &target, distance)?;
            let left_over = length(self.trees[side].q(near), &target);
            // A projection may lead elsewhere.
            if left_over > distance * (1.0 - LEAST_PROGRESS) {
                return None;
            }
            distance = left_over;
        }
        (distance == 0.0).then_some(near)
    }

    fn path(&self, side: usize, node: usize, other: usize) -> Vec<Vec<f64>> {
        let branch = |tree: &Tree, node: usize| -> Vec<Vec<f64>> {
            tree.branch(node).into_iter().map(|n| tree.q(n).to_vec()).collect()
        };
        let (from_start, to_goal) = if side == 0 { (node, other) } else { (other, node) };
        let mut path = branch(&self.trees[0], from_start);
        path.reverse();
        path.extend(branch(&self.trees[1], to_goal));
        path.dedup();
        path
    }
}
