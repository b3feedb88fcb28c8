//! Greedy steps to a near leaf: no proof, only a good place to start.

use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{V3, W16, load16, rows16, splat16};
use super::placement::Placement;
use super::tree::{FAN, Tree};

/// The child of a node that looks nearest to `spot`; `seen` places the node's mesh in the spot's frame.
#[inline(always)]
fn nearest_child<S: Simd>(
    simd: S,
    tree: &Tree,
    height: usize,
    number: usize,
    seen: &Placement,
    spot: [f32; 3],
) -> usize {
    let node = &tree.levels[height - 1][number];
    let (c, h) = (load16(simd, &node.center), load16(simd, &node.half));
    let c = c.mapped(&rows16(simd, &seen.m)).plus(splat16(simd, seen.t)).minus(splat16(simd, spot));
    let h = h.mapped(&rows16(simd, &seen.abs));
    let zero = W16::splat(simd, 0.0);
    let gap = V3((c.0.abs() - h.0).max(zero), (c.1.abs() - h.1).max(zero), (c.2.abs() - h.2).max(zero));
    // Overlapping boxes are told apart by their centres.
    let key = gap.dot(gap) + c.dot(c) * W16::splat(simd, 1e-2);
    let mut keys = [0.0f32; FAN];
    key.store_slice(&mut keys);
    let count = tree.children(height, number).count_ones() as usize;
    let mut best = 0;
    for i in 1..count {
        if keys[i] < keys[best] {
            best = i;
        }
    }
    number * FAN + best
}

/// The leaf of `tree` that looks nearest to `spot`.
pub(super) fn nearest_leaf(level: Level, tree: &Tree, seen: &Placement, spot: [f32; 3]) -> usize {
    dispatch!(level, simd => {
        let mut number = 0;
        for height in (1..=tree.height()).rev() {
            number = nearest_child(simd, tree, height, number, seen, spot);
        }
        number
    })
}
