//! RRT-Connect (Kuffner, `LaValle`: *RRT-Connect: an efficient approach to single-query path planning*, 2000), lazily proven:
//! edges are looked at where they are made and proven where they are on a path; one that the proof refuses is cut off
//! with all that hangs on it, and the search goes on.

use super::bounds::Window;
use super::random::Random;
use super::tree::Tree;
use super::way::{Way, lerp};

/// An edge moves solids no farther than about so much (rad or m) of the joint that moves them most would.
const EDGE: f64 = 0.6;
/// After so many samples everything within the limits is looked through; before, what is near the ends.
const WIDE: f64 = 300.0;

/// Two trees that grow towards each other.
pub(super) struct Search<'w, 's> {
    way: &'w mut Way<'s>,
    window: &'w Window,
    random: &'w mut Random,
    /// The first is that of the start where `swapped` is false.
    trees: [Tree; 2],
    swapped: bool,
}

impl<'w, 's> Search<'w, 's> {
    pub fn new(way: &'w mut Way<'s>, window: &'w Window, random: &'w mut Random, [start, goal]: [&[f64]; 2]) -> Self {
        Self { way, window, random, trees: [Tree::new(start), Tree::new(goal)], swapped: false }
    }

    /// Number of states in both trees.
    pub fn nodes(&self) -> usize {
        self.trees.iter().map(Tree::len).sum()
    }

    /// Waypoints of a proven path; `None` where time is up.
    pub fn run(&mut self) -> Option<Vec<Vec<f64>>> {
        let mut sample = self.trees[0].q(0).to_vec();
        for round in 0_u32.. {
            if self.way.late() {
                break;
            }
            // At first near the ends; later anywhere, and near the ends still at times.
            let share = if round % 3 == 2 { 0.3 } else { (0.1 + f64::from(round) / WIDE).min(1.0) };
            self.window.sample(share, self.random, &mut sample);
            let from = self.trees[0].nearest(&sample, &self.way.reach);
            if let Some((node, _)) = self.grow(0, from, &sample) {
                let target = self.trees[0].q(node).to_vec();
                let near = self.trees[1].nearest(&target, &self.way.reach);
                if let Some((other, true)) = self.grow(1, near, &target)
                    && let Some(path) = self.joined(node, other)
                {
                    return Some(path);
                }
            }
            self.trees.swap(0, 1);
            self.swapped = !self.swapped;
        }
        None
    }

    /// Towards a target, edge by edge until something is in the way; the last node made and whether it is the target. `None`:
    /// not even one edge.
    fn grow(&mut self, tree: usize, from: usize, target: &[f64]) -> Option<(usize, bool)> {
        let (mut last, mut made) = (from, None);
        let mut next = target.to_vec();
        loop {
            let here = self.trees[tree].q(last).to_vec();
            let far = self.way.travel(&here, target);
            if far == 0.0 {
                return Some((last, true));
            }
            let arrives = far <= EDGE;
            if arrives {
                next.copy_from_slice(target);
            } else {
                lerp(&here, target, EDGE / far, &mut next);
            }
            if !self.way.looks_free(&here, &next) {
                break;
            }
            last = self.trees[tree].add(last, &next);
            made = Some((last, arrives));
            if arrives || self.way.late() {
                break;
            }
        }
        made
    }

    /// Both branches as one path, each edge proven; `None` where one is refused, which cuts it off.
    fn joined(&mut self, node: usize, other: usize) -> Option<Vec<Vec<f64>>> {
        let mut path = Vec::new();
        for (tree, end) in [(0, node), (1, other)] {
            let branch = self.trees[tree].branch(end);
            // From the root: what is refused early cuts off most.
            for &n in branch.iter().rev().skip(1) {
                if self.trees[tree].is_proven(n) {
                    continue;
                }
                let (a, b) = (self.trees[tree].q(self.trees[tree].parent(n)), self.trees[tree].q(n));
                if !self.way.proven(a, b) {
                    self.trees[tree].cut(n);
                    return None;
                }
                self.trees[tree].prove(n);
            }
            let states = branch.iter().map(|n| self.trees[tree].q(*n).to_vec());
            if tree == 0 {
                path.extend(states);
                path.reverse();
            } else {
                // Both have the state where they meet.
                path.extend(states.skip(1));
            }
        }
        if self.swapped {
            path.reverse();
        }
        Some(path)
    }
}
