//! Pairs of nodes that are still to be expanded.

use crate::bvh::{ARITY, Bvh16};

/// A pair of nodes that is still to be expanded.
#[derive(Debug, Clone, Copy)]
pub(super) struct NodePair {
    pub a: u32,
    pub b: u32,
    /// A lower bound of the distance; see [`expand`](super::node_kernel::expand).
    pub key: f32,
    pub height_a: u8,
    pub height_b: u8,
}

/// A selection of one or both of two nodes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sides {
    pub a: bool,
    pub b: bool,
}

impl NodePair {
    #[inline(always)]
    pub fn root(a: &Bvh16, b: &Bvh16) -> Self {
        Self { a: 0, b: 0, key: f32::MIN, height_a: a.height() as u8, height_b: b.height() as u8 }
    }

    #[inline(always)]
    pub fn is_leaves(&self) -> bool {
        self.height_a == 0 && self.height_b == 0
    }

    /// The nodes that are replaced by their children: the higher node, or both if they are equally high.
    #[inline(always)]
    pub fn expanded_sides(&self) -> Sides {
        Sides { a: self.height_a >= self.height_b, b: self.height_b >= self.height_a }
    }

    /// The pair of lanes `i` and `j` of the two nodes.
    #[inline(always)]
    pub fn child(&self, i: usize, j: usize, key: f32) -> Self {
        self.child_of(self.expanded_sides(), i, j, key)
    }

    /// Like [`NodePair::child`], with a selection of expanded nodes.
    #[inline(always)]
    pub fn child_of(&self, expanded: Sides, i: usize, j: usize, key: f32) -> Self {
        let (a, height_a) =
            if expanded.a { (self.a * ARITY as u32 + i as u32, self.height_a - 1) } else { (self.a, self.height_a) };
        let (b, height_b) =
            if expanded.b { (self.b * ARITY as u32 + j as u32, self.height_b - 1) } else { (self.b, self.height_b) };
        Self { a, b, key, height_a, height_b }
    }
}

/// Each step down pushes at most 256 pairs and removes one. Trees over 2³² triangles in leaves of 8 have a height of
/// 8, and pairs of unequal height push 16 per step until they are equal.
const CAPACITY: usize = 8 * 256 + 8 * 16;

/// A stack of pairs of nodes that are still to be expanded.
#[derive(Debug, Clone)]
pub(super) struct NodePairStack {
    entries: [NodePair; CAPACITY],
    len: usize,
    overflowed: bool,
}

impl NodePairStack {
    #[allow(
        clippy::large_stack_arrays,
        reason = "it lives in static or boxed memory; making it is not part of a query"
    )]
    pub const fn new() -> Self {
        let blank = NodePair { a: 0, b: 0, key: 0.0, height_a: 0, height_b: 0 };
        Self { entries: [blank; CAPACITY], len: 0, overflowed: false }
    }

    pub fn clear(&mut self) {
        (self.len, self.overflowed) = (0, false);
    }

    pub fn len(&self) -> usize {
        self.len
    }

    /// True if a pair was lost: then nothing can be proven to be apart.
    pub fn overflowed(&self) -> bool {
        self.overflowed
    }

    #[inline(always)]
    pub fn push(&mut self, pair: NodePair) {
        match self.entries.get_mut(self.len) {
            Some(slot) => (*slot, self.len) = (pair, self.len + 1),
            None => self.overflowed = true,
        }
    }

    #[inline(always)]
    pub fn pop(&mut self) -> Option<NodePair> {
        self.len = self.len.checked_sub(1)?;
        self.entries.get(self.len).copied()
    }

    /// Sorts the entries from this one on, so that the one with the smallest key is next.
    pub fn sort_from(&mut self, first: usize, key: impl Fn(&NodePair) -> f64) {
        if let Some(entries) = self.entries.get_mut(first..self.len) {
            entries.sort_unstable_by(|a, b| key(b).total_cmp(&key(a)));
        }
    }

    /// Makes this entry the next.
    #[inline(always)]
    pub fn bring_to_top(&mut self, number: usize) {
        if number < self.len && self.len <= CAPACITY {
            self.entries.swap(number, self.len - 1);
        }
    }
}
