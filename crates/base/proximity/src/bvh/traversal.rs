//! Traversal of one tree in the order of a lower bound.

use super::bvh16::Bvh16;
use super::node::{ARITY, LEAF_SIZE};
use super::node_bound::NodeBound;

/// A subtree still to be visited.
#[derive(Clone, Copy)]
struct PendingNode {
    bound: f32,
    number: u32,
    height: u8,
}

/// Each step down leaves at most 15 siblings on the stack, and trees have a height of 8.
const STACK_SIZE: usize = 16 * 10;

impl Bvh16 {
    /// Calls `leaf` with the index of every triangle whose bound is not above `limit`, smallest bound of siblings first;
    /// `leaf` returns the limit for the rest of the traversal.
    pub(crate) fn traverse(&self, query: &dyn NodeBound, limit: f32, leaf: &mut dyn FnMut(usize) -> f32) {
        self.traverse_leaves(query, limit, &mut |mut triangles, mut limit| {
            while let Some((_, triangle)) = triangles.next(limit) {
                limit = leaf(triangle);
            }
            limit
        });
    }

    /// Calls `leaf` with the triangles of every leaf whose bound is not above `limit`, and the limit; it returns the limit
    /// for the rest of the traversal.
    pub(crate) fn traverse_leaves(
        &self,
        query: &dyn NodeBound,
        mut limit: f32,
        leaf: &mut dyn FnMut(LeafTriangles<'_>, f32) -> f32,
    ) {
        let mut stack = [PendingNode { bound: 0.0, number: 0, height: 0 }; STACK_SIZE];
        stack[0] = PendingNode { bound: f32::NEG_INFINITY, number: 0, height: self.height() as u8 };
        let mut len = 1;
        while len > 0 {
            len -= 1;
            let PendingNode { bound, number, height } = stack[len];
            // A NaN is visited: an unknown bound must not exclude a child.
            if bound > limit {
                continue;
            }
            let number = number as usize;
            if height == 0 {
                limit = leaf(LeafTriangles::new(self, query, number), limit);
                continue;
            }
            let bounds = query.lower_bounds(self.node(height as usize, number));
            let mut left = self.children(height as usize, number);
            let first = len;
            while let Some(lane) = take_smallest(&bounds, &mut left, limit) {
                let number = (number * ARITY + lane) as u32;
                stack[len] = PendingNode { bound: bounds[lane], number, height: height - 1 };
                len += 1;
            }
            stack[first..len].reverse();
        }
    }
}

/// The triangles of a leaf that are still to be visited.
pub(crate) struct LeafTriangles<'t> {
    tree: &'t Bvh16,
    first: usize,
    bounds: [f32; LEAF_SIZE],
    left: u32,
}

impl<'t> LeafTriangles<'t> {
    fn new(tree: &'t Bvh16, query: &dyn NodeBound, number: usize) -> Self {
        let bounds = query.leaf_bounds(&tree.leaves[number]);
        Self { tree, first: number * LEAF_SIZE, bounds, left: (1u32 << tree.leaf_len(number)) - 1 }
    }

    /// Takes the triangle with the smallest bound, if it is not above the limit: its lane and its index.
    pub fn next(&mut self, limit: f32) -> Option<(usize, usize)> {
        let lane = take_smallest(&self.bounds, &mut self.left, limit)?;
        Some((lane, self.triangle(lane)))
    }

    /// The triangles whose bounds are not above the limit: their lanes and their indices.
    pub fn within(&self, limit: f32) -> impl Iterator<Item = (usize, usize)> + '_ {
        let is_within = move |lane: &usize| self.left >> lane & 1 == 1 && !(self.bounds[*lane] > limit);
        (0..LEAF_SIZE).filter(is_within).map(|lane| (lane, self.triangle(lane)))
    }

    fn triangle(&self, lane: usize) -> usize {
        self.tree.triangle((self.first + lane) as u32)
    }
}

/// Removes the lane of the smallest bound from `left`; `None` if all remaining bounds are above the limit.
#[inline(always)]
fn take_smallest(bounds: &[f32], left: &mut u32, limit: f32) -> Option<usize> {
    let mut best: Option<usize> = None;
    let mut rest = *left;
    while rest != 0 {
        let lane = rest.trailing_zeros() as usize;
        rest &= rest - 1;
        if bounds[lane] > limit {
            *left &= !(1 << lane);
        } else if best.is_none_or(|b| bounds[lane] < bounds[b]) {
            best = Some(lane);
        }
    }
    if let Some(lane) = best {
        *left &= !(1 << lane);
    }
    best
}
