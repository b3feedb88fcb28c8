//! A first upper bound of the distance: a beam search down both trees by the distances of landmarks, which are
//! points of the surfaces.
//!
//! It does not prove a lower bound, and costs less than expanding a few nodes.

use fearless_simd::{Simd, dispatch, prelude::*};

use super::mesh_pair::MeshPair;
use super::node_pair::NodePair;
use crate::bvh::{ARITY, Bvh16, LEAF_SIZE, Leaf, Node};
use crate::lanes::{V3, W8, W16, load_corners, load16, rows8, rows16, splat8, splat16, store16};

/// Largest width of the beam: the number of node pairs that are followed at each height.
const MAX_WIDTH: usize = 4;
/// Number of pairs of triangles that are returned.
const RETURNED: usize = 8;

/// The nearest items offered, in ascending order of distance, at most `capacity`.
struct Beam<T, const N: usize> {
    items: [(f32, T); N],
    len: usize,
    capacity: usize,
}

impl<T: Copy, const N: usize> Beam<T, N> {
    fn new(blank: T, capacity: usize) -> Self {
        Self { items: [(f32::INFINITY, blank); N], len: 0, capacity: capacity.clamp(1, N) }
    }

    /// Only items nearer than this are kept.
    #[inline(always)]
    fn worst(&self) -> f32 {
        if self.len == self.capacity { self.items[self.capacity - 1].0 } else { f32::INFINITY }
    }

    #[inline(always)]
    fn offer(&mut self, square: f32, item: T) {
        if square >= self.worst() {
            return;
        }
        self.len = (self.len + 1).min(self.capacity);
        let mut at = self.len - 1;
        while at > 0 && square < self.items[at - 1].0 {
            self.items[at] = self.items[at - 1];
            at -= 1;
        }
        self.items[at] = (square, item);
    }

    fn iter(&self) -> impl Iterator<Item = &(f32, T)> {
        self.items[..self.len].iter()
    }
}

type NodeBeam = Beam<NodePair, MAX_WIDTH>;
type SlotBeam = Beam<(u32, u32), RETURNED>;

/// Slots of the triangles whose centroids are nearest at the end of a beam search, the nearest first. If fewer are
/// found than are returned, the first is repeated.
pub(super) fn nearest_landmark_pairs(meshes: &MeshPair, width: usize) -> [(u32, u32); RETURNED] {
    let root = NodePair::root(&meshes.a.bvh, &meshes.b.bvh);
    let mut beam = NodeBeam::new(root, width);
    beam.offer(0.0, root);
    while beam.iter().any(|(_, pair)| !pair.is_leaves()) {
        let mut next = NodeBeam::new(root, width);
        for (square, pair) in beam.iter() {
            if pair.is_leaves() {
                next.offer(*square, *pair);
            } else {
                offer_children(meshes, pair, &mut next);
            }
        }
        beam = next;
    }
    let mut nearest = SlotBeam::new((0, 0), RETURNED);
    for (_, pair) in beam.iter() {
        offer_triangles(meshes, pair, &mut nearest);
    }
    let mut slots = nearest.items.map(|(_, slots)| slots);
    let first = slots[0];
    slots[nearest.len..].fill(first);
    slots
}

/// Offers, for each child of A's node, the nearest child of B's node.
fn offer_children(meshes: &MeshPair, pair: &NodePair, next: &mut NodeBeam) {
    let expanded = pair.expanded_sides();
    let (node_a, mask_a) = lanes(&meshes.a.bvh, pair.a, pair.height_a, expanded.a);
    let (node_b, mask_b) = lanes(&meshes.b.bvh, pair.b, pair.height_b, expanded.b);
    let (worst, b_in_a) = (next.worst(), &meshes.placement.b_in_a);
    let NearestPartners { squares, partners, better } = dispatch!(meshes.simd_level, simd => {
        let of_b = load16(simd, &node_b.landmark).placed(&rows16(simd, &b_in_a.m), splat16(simd, b_in_a.t));
        nearest_partners(simd, load16(simd, &node_a.landmark), &store16(of_b), mask_b, worst)
    });
    for i in bits(mask_a & better) {
        next.offer(squares[i], pair.child(i, partners[i] as usize, squares[i]));
    }
}

/// A node and the mask of its lanes to test: all children, or the node's own lane in its parent.
fn lanes(tree: &Bvh16, number: u32, height: u8, expanded: bool) -> (&Node, u32) {
    let (number, height) = (number as usize, height as usize);
    if expanded {
        (tree.node(height, number), tree.children(height, number))
    } else {
        let (parent, lane) = tree.parent(height, number);
        (parent, 1 << lane)
    }
}

/// Offers, for each triangle of A's leaf, the nearest triangle of B's leaf.
fn offer_triangles(meshes: &MeshPair, pair: &NodePair, nearest: &mut SlotBeam) {
    let (a, b) = (&meshes.a.bvh, &meshes.b.bvh);
    let (leaf_a, leaf_b) = (pair.a as usize, pair.b as usize);
    let (count_a, count_b) = (a.leaf_len(leaf_a), b.leaf_len(leaf_b));
    let (worst, b_in_a) = (nearest.worst(), &meshes.placement.b_in_a);
    let NearestPartners { squares, partners, better } = dispatch!(meshes.simd_level, simd => {
        let (rows, shift) = (rows8(simd, &b_in_a.m), splat8(simd, b_in_a.t));
        let of_b = centroids(simd, &b.leaves[leaf_b]).placed(&rows, shift);
        let zero = splat8(simd, [0.0; 3]);
        let of_b = store16(V3(of_b.0.combine(zero.0), of_b.1.combine(zero.1), of_b.2.combine(zero.2)));
        let of_a = centroids(simd, &a.leaves[leaf_a]);
        let of_a = V3(of_a.0.combine(zero.0), of_a.1.combine(zero.1), of_a.2.combine(zero.2));
        nearest_partners(simd, of_a, &of_b, (1 << count_b) - 1, worst)
    });
    for i in bits(better & ((1 << count_a) - 1)) {
        let slot = |leaf: usize, lane: usize| (leaf * LEAF_SIZE + lane) as u32;
        nearest.offer(squares[i], (slot(leaf_a, i), slot(leaf_b, partners[i] as usize)));
    }
}

/// Centroids of eight triangles.
#[inline(always)]
fn centroids<S: Simd>(simd: S, leaf: &Leaf) -> V3<W8<S>> {
    let [p, q, r] = load_corners(simd, &leaf.corner);
    p.plus(q).plus(r).times(W8::splat(simd, 1.0 / 3.0))
}

/// The nearest partner of each of sixteen points: its squared distance and its number.
struct NearestPartners {
    squares: [f32; ARITY],
    partners: [f32; ARITY],
    /// Bit mask of the partners nearer than the threshold.
    better: u32,
}

#[inline(always)]
fn nearest_partners<S: Simd>(
    simd: S,
    points: V3<W16<S>>,
    others: &[[f32; ARITY]; 3],
    mask: u32,
    threshold: f32,
) -> NearestPartners {
    let mut best = W16::splat(simd, f32::INFINITY);
    let mut partner = W16::splat(simd, 0.0);
    for j in bits(mask) {
        let apart = points.minus(splat16(simd, [others[0][j], others[1][j], others[2][j]]));
        let square = apart.dot(apart);
        let nearer = square.simd_lt(best);
        best = nearer.select(square, best);
        partner = nearer.select(W16::splat(simd, j as f32), partner);
    }
    let better = best.simd_lt(threshold).to_bitmask() as u32;
    let (mut squares, mut partners) = ([0.0; ARITY], [0.0; ARITY]);
    best.store_slice(&mut squares);
    partner.store_slice(&mut partners);
    NearestPartners { squares, partners, better }
}

#[inline(always)]
fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = mask.trailing_zeros() as usize;
        (mask != 0).then(|| {
            mask &= mask - 1;
            bit
        })
    })
}
