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
    pub(crate) fn traverse(&self, query: &dyn NodeBound, mut limit: f32, leaf: &mut dyn FnMut(usize) -> f32) {
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
                limit = self.visit_leaf(query, number, limit, leaf);
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

    fn visit_leaf(&self, query: &dyn NodeBound, number: usize, limit: f32, leaf: &mut dyn FnMut(usize) -> f32) -> f32 {
        let first = number * LEAF_SIZE;
        let bounds = query.leaf_bounds(&self.leaves[number]);
        let mut left = (1u32 << self.leaf_len(number)) - 1;
        let mut limit = limit;
        while let Some(lane) = take_smallest(&bounds, &mut left, limit) {
            limit = leaf(self.triangle((first + lane) as u32));
        }
        limit
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
