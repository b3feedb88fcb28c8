//! RRT-Connect (Kuffner, `LaValle`: *RRT-Connect: an efficient approach to single-query path planning*, 2000) with lazy
//! proofs: edges are checked discretely when they are added, and proven when they are part of a path. An edge that
//! cannot be proven is pruned with its subtree, and the search continues.

use super::interpolation::lerp;
use super::joint_bounds::SamplingRegion;
use super::motion_validator::MotionValidator;
use super::random::Random;
use super::tree::Tree;

/// Number of samples after which the whole region is sampled; before, samples stay around the ends.
const WIDENING_ROUNDS: f64 = 300.0;
/// Fraction of the region, around the ends, that is sampled first.
const FIRST_SHARE: f64 = 0.1;
/// Every Nth sample stays near the ends, in the fraction `NEAR_SHARE` of the region: exits of narrow starts and goals
/// are there.
const NEAR_ROUNDS: u32 = 3;
const NEAR_SHARE: f64 = 0.3;

/// Two trees that grow towards each other.
pub(super) struct BidirectionalSearch<'w, 's> {
    validator: &'w mut MotionValidator<'s>,
    region: &'w SamplingRegion,
    random: &'w mut Random,
    /// If `swapped` is false, the first tree belongs to the start.
    trees: [Tree; 2],
    swapped: bool,
    edge_length: f64,
}

impl<'w, 's> BidirectionalSearch<'w, 's> {
    pub fn new(
        validator: &'w mut MotionValidator<'s>,
        region: &'w SamplingRegion,
        random: &'w mut Random,
        [start, goal]: [&[f64]; 2],
        edge_length: f64,
    ) -> Self {
        let trees = [Tree::new(start), Tree::new(goal)];
        Self { validator, region, random, trees, swapped: false, edge_length }
    }

    /// Number of nodes in both trees.
    pub fn nodes(&self) -> usize {
        self.trees.iter().map(Tree::len).sum()
    }

    /// Searches for a path. Returns the waypoints of a proven path; `None` if a limit is reached.
    pub fn run(&mut self) -> Option<Vec<Vec<f64>>> {
        let mut sample = self.trees[0].q(0).to_vec();
        for round in 0_u32.. {
            if self.validator.is_exhausted() {
                break;
            }
            // At first near the ends, later anywhere; every third round stays near the ends.
            let is_near = round % NEAR_ROUNDS == NEAR_ROUNDS - 1;
            let share = if is_near { NEAR_SHARE } else { (FIRST_SHARE + f64::from(round) / WIDENING_ROUNDS).min(1.0) };
            self.region.sample(share, self.random, &mut sample);
            let from = self.trees[0].nearest(&sample, &self.validator.weights);
            if let Some((node, _)) = self.extend(0, from, &sample) {
                let target = self.trees[0].q(node).to_vec();
                let near = self.trees[1].nearest(&target, &self.validator.weights);
                if let Some((other, true)) = self.extend(1, near, &target)
                    && let Some(path) = self.proven_path(node, other)
                {
                    return Some(path);
                }
            }
            self.trees.swap(0, 1);
            self.swapped = !self.swapped;
        }
        None
    }

    /// Extends a tree towards a target, edge by edge, until an edge is not free. Returns the last added node and
    /// whether it is the target; `None` if no edge was added.
    fn extend(&mut self, tree: usize, from: usize, target: &[f64]) -> Option<(usize, bool)> {
        let (mut last, mut added) = (from, None);
        let mut next = target.to_vec();
        loop {
            let here = self.trees[tree].q(last).to_vec();
            let distance = self.validator.distance(&here, target);
            if distance == 0.0 {
                return Some((last, true));
            }
            let reaches = distance <= self.edge_length;
            if reaches {
                next.copy_from_slice(target);
            } else {
                lerp(&here, target, self.edge_length / distance, &mut next);
            }
            if !self.validator.discrete_check(&here, &next) {
                break;
            }
            last = self.trees[tree].add(last, &next);
            added = Some((last, reaches));
            if reaches || self.validator.is_exhausted() {
                break;
            }
        }
        added
    }

    /// Joins two branches to one path and proves each edge; `None` if an edge is not proven, which is then pruned.
    fn proven_path(&mut self, node: usize, other: usize) -> Option<Vec<Vec<f64>>> {
        let mut path = Vec::new();
        for (tree, end) in [(0, node), (1, other)] {
            let branch = self.trees[tree].branch(end);
            // From the root: edges near the root prune the largest subtrees.
            for &n in branch.iter().rev().skip(1) {
                if self.trees[tree].is_proven(n) {
                    continue;
                }
                let (a, b) = (self.trees[tree].q(self.trees[tree].parent(n)), self.trees[tree].q(n));
                if !self.validator.proves_motion(a, b) {
                    self.trees[tree].prune(n);
                    return None;
                }
                self.trees[tree].mark_proven(n);
            }
            let states = branch.iter().map(|n| self.trees[tree].q(*n).to_vec());
            if tree == 0 {
                path.extend(states);
                path.reverse();
            } else {
                // The configuration at which the branches meet is in both.
                path.extend(states.skip(1));
            }
        }
        if self.swapped {
            path.reverse();
        }
        Some(path)
    }
}
