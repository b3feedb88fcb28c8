//! RRT-Connect (Kuffner, `LaValle`: *RRT-Connect: an efficient approach to single-query path planning*, 2000) with a dynamic
//! domain (Yershova, Jaillet, Siméon, `LaValle`: *Dynamic-domain RRTs*, 2005): a node from which an extension failed is extended
//! only towards nearby samples. Its domain adapts, as in Jaillet, Yershova, `LaValle`, Siméon: *Adaptive tuning of the sampling
//! domain for dynamic-domain RRTs*, 2005; but it grows with each sample that it keeps out, not with successes.
//!
//! Proofs are lazy: edges of a path are proven when the trees meet; an edge that cannot be proven is pruned with its subtree,
//! and the search continues.

use super::motion_validator::MotionValidator;
use super::tree::Tree;
use crate::interpolation::{length, lerp};

/// Dynamic domain of a node after a failure, rad (and m).
const DOMAIN_RADIUS: f32 = 4.0;
/// Factor of a domain for each sample beyond it. Where most samples are far away, as for robots with many joints that turn
/// without end, hundreds are kept out for each one that is tried; then the domain grows, until one is tried and fails.
const DOMAIN_GROWTH: f32 = 1.001;

/// Number of failed extensions in a row from which several are tried at once: where most fail, a test that only rejects
/// pays; elsewhere the first one is likely to succeed.
const FAILURES: usize = 4;
/// Largest number of samples that are drawn for one round of extensions.
const SAMPLES: usize = 64;

/// Smallest gain of a step of a connection, as a fraction of the distance to its target; a step with less gain is the
/// last.
pub(crate) const LEAST_PROGRESS: f64 = 0.05;

/// Draws configurations.
pub(crate) trait ConfigurationSampler {
    /// A configuration for a tree to grow towards; one of its roots is `root`.
    fn sample(&mut self, root: &[f64], out: &mut [f64]);
}

/// An edge by which a tree may grow.
struct Extension {
    /// The node that it begins at.
    near: usize,
    /// The configuration that it ends at.
    end: Vec<f64>,
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
        let mut extensions = Vec::new();
        let (mut round, mut failures) = (0, 0);
        loop {
            if self.trees[0].len() > self.trees[1].len() {
                self.trees.swap(0, 1);
                self.is_swapped = !self.is_swapped;
            }
            let count = if failures < FAILURES { 1 } else { self.validator.motions_at_once() };
            extensions.clear();
            for _ in 0..SAMPLES {
                if self.validator.is_exhausted() {
                    return None;
                }
                sampler.sample(self.trees[0].q(round % self.trees[0].roots()), &mut sample);
                round += 1;
                extensions.extend(self.extension(&sample));
                if extensions.len() == count {
                    break;
                }
            }
            let failing = self.failing(&extensions);
            for (index, extension) in extensions.drain(..).enumerate() {
                if failing >> index & 1 == 1 {
                    self.shrink_domain(0, extension.near);
                    failures += 1;
                    continue;
                }
                let Some(node) = self.extend(0, extension) else {
                    failures += 1;
                    continue;
                };
                failures = 0;
                if let Some(other) = self.connect(node)
                    && self.is_proven(node, other)
                {
                    return Some(self.path(node, other));
                }
                break;
            }
        }
    }

    /// The extension of the first tree towards a sample, if that is in the domain of its nearest node.
    fn extension(&mut self, sample: &[f64]) -> Option<Extension> {
        let (near, distance) = self.trees[0].nearest(sample);
        if f64::from(self.trees[0].radii[near]) < distance {
            self.trees[0].radii[near] *= DOMAIN_GROWTH;
            return None;
        }
        if distance > 0.0 { self.step(0, near, sample, distance) } else { None }
    }

    /// Which of several extensions certainly fail, if there are several: one bit each.
    fn failing(&mut self, extensions: &[Extension]) -> u32 {
        if extensions.len() < 2 {
            return 0;
        }
        let motions: Vec<_> = extensions.iter().map(|e| (self.trees[0].q(e.near), &e.end[..])).collect();
        self.validator.failing_motions(&motions)
    }

    /// The extension of a node towards a target; `None` if its end cannot satisfy the constraint.
    fn step(&mut self, tree: usize, near: usize, target: &[f64], distance: f64) -> Option<Extension> {
        let mut end = target.to_vec();
        let longest = self.validator.longest_edge();
        if distance > longest {
            lerp(self.trees[tree].q(near), target, longest / distance, &mut end);
        }
        if !self.validator.project(&mut end) {
            self.shrink_domain(tree, near);
            return None;
        }
        Some(Extension { near, end })
    }

    /// Adds an edge, if its motion is free. Returns the new node.
    fn extend(&mut self, tree: usize, Extension { near, end }: Extension) -> Option<usize> {
        if !self.validator.motion_is_free(self.trees[tree].q(near), &end) {
            self.shrink_domain(tree, near);
            return None;
        }
        Some(self.trees[tree].add(near, &end))
    }

    /// Makes the domain of a node smaller after a failed extension.
    fn shrink_domain(&mut self, tree: usize, node: usize) {
        let radius = &mut self.trees[tree].radii[node];
        *radius = radius.min(DOMAIN_RADIUS) * 0.999_9;
    }

    /// Grows the second tree straight to a node of the first. Returns the node that reaches it.
    fn connect(&mut self, node: usize) -> Option<usize> {
        let target = self.trees[0].q(node).to_vec();
        let (mut near, mut distance) = self.trees[1].nearest(&target);
        while distance > 0.0 && !self.validator.is_exhausted() {
            let extension = self.step(1, near, &target, distance)?;
            near = self.extend(1, extension)?;
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A point in the square from 0 to 1, with a wall at x = 0.5 below y = 0.99.
    struct Wall {
        questions: usize,
        most: usize,
        /// Motions that were known to fail and may not be tested.
        failing: Vec<Vec<f64>>,
        batches: usize,
    }

    impl Wall {
        fn blocks(from: &[f64], to: &[f64]) -> bool {
            let share = (0.5 - from[0]) / (to[0] - from[0]);
            (0.0..=1.0).contains(&share) && from[1] + share * (to[1] - from[1]) < 0.99
        }
    }

    impl MotionValidator for Wall {
        fn motion_is_free(&mut self, from: &[f64], to: &[f64]) -> bool {
            assert!(!self.failing.iter().any(|end| end == to), "{to:?} is known to fail");
            !Self::blocks(from, to)
        }

        fn motions_at_once(&self) -> usize {
            4
        }

        fn failing_motions(&mut self, motions: &[(&[f64], &[f64])]) -> u32 {
            assert!((2..=4).contains(&motions.len()));
            self.batches += 1;
            let blocked = |(index, (from, to)): (usize, &(&[f64], &[f64]))| u32::from(Self::blocks(from, to)) << index;
            let failing = motions.iter().enumerate().map(blocked).sum::<u32>();
            let ends = motions.iter().enumerate().filter(|(index, _)| failing >> index & 1 == 1);
            self.failing = ends.map(|(_, (_, to))| to.to_vec()).collect();
            failing
        }

        fn is_exhausted(&mut self) -> bool {
            self.questions += 1;
            self.questions > self.most
        }

        fn longest_edge(&self) -> f64 {
            0.2
        }
    }

    impl<F: FnMut(&mut [f64])> ConfigurationSampler for F {
        fn sample(&mut self, _: &[f64], out: &mut [f64]) {
            self(out);
        }
    }

    fn wall(most: usize) -> Wall {
        Wall { questions: 0, most, failing: Vec::new(), batches: 0 }
    }

    #[test]
    fn motions_that_certainly_fail_are_not_tested_and_a_path_is_found() {
        let (mut validator, mut random) = (wall(100_000), elbowroom_testkit::random::Random(4));
        let mut search = TreeSearch::new(&mut validator, &[0.4, 0.1], [&[0.6, 0.1][..]]);
        let path = search.run(&mut |q: &mut [f64]| q.fill_with(|| random.unit())).unwrap();
        assert!(path.windows(2).all(|edge| !Wall::blocks(&edge[0], &edge[1])));
        assert!(validator.batches > 10, "{}", validator.batches);
    }

    #[test]
    fn whether_the_search_must_end_is_asked_for_each_sample() {
        let (mut validator, mut samples) = (wall(50), 0);
        let mut search = TreeSearch::new(&mut validator, &[0.4, 0.1], [&[0.6, 0.1][..]]);
        let found = search.run(&mut |q: &mut [f64]| {
            samples += 1;
            q.copy_from_slice(&[0.4, 0.1]);
        });
        assert!(found.is_none());
        assert_eq!(samples, 50);
    }
}
