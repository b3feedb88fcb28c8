//! Where to begin: a descent of both trees by points of their surfaces. Proves nothing, and costs less than opening a few
//! nodes.

use fearless_simd::{Level, Simd, dispatch, prelude::*};

use super::lanes::{V3, W8, W16, load_corners, load16, rows8, rows16, splat8, splat16, store16};
use super::placement::Pairing;
use super::scratch::{Entry, filling};
use super::tree::{FAN, LEAF, Leaf, Node, Tree};

/// Pairs of nodes that are followed at each height, at most.
const WIDEST: usize = 4;
/// Pairs of triangles that are told.
const FOUND: usize = 8;

/// The nearest of what was seen, in order.
struct Nearest<T, const N: usize> {
    best: [(f32, T); N],
    len: usize,
    most: usize,
}

impl<T: Copy, const N: usize> Nearest<T, N> {
    fn new(blank: T, most: usize) -> Self {
        Self { best: [(f32::INFINITY, blank); N], len: 0, most: most.clamp(1, N) }
    }

    /// What is farther would be of no use.
    #[inline(always)]
    fn farthest(&self) -> f32 {
        if self.len == self.most { self.best[self.most - 1].0 } else { f32::INFINITY }
    }

    #[inline(always)]
    fn offer(&mut self, square: f32, what: T) {
        if square >= self.farthest() {
            return;
        }
        self.len = (self.len + 1).min(self.most);
        let mut at = self.len - 1;
        while at > 0 && square < self.best[at - 1].0 {
            self.best[at] = self.best[at - 1];
            at -= 1;
        }
        self.best[at] = (square, what);
    }
}

type Beam = Nearest<Entry, WIDEST>;

/// Slots of triangles that look nearest, the nearest first; where there are fewer, the first again.
pub(super) fn promising(level: Level, a: &Tree, b: &Tree, pairing: &Pairing, width: usize) -> [(u32, u32); FOUND] {
    let root = Entry::root(a, b);
    let mut beam = Beam::new(root, width);
    beam.offer(0.0, root);
    while beam.best[..beam.len].iter().any(|(_, pair)| !pair.is_leaves()) {
        let mut next = Beam::new(root, width);
        for (square, pair) in &beam.best[..beam.len] {
            if pair.is_leaves() {
                next.offer(*square, *pair);
            } else {
                children(level, (a, b), pair, pairing, &mut next);
            }
        }
        beam = next;
    }
    let mut nearest = Nearest::<(u32, u32), FOUND>::new((0, 0), FOUND);
    for (_, pair) in &beam.best[..beam.len] {
        triangles(level, (a, b), pair, pairing, &mut nearest);
    }
    let mut slots = nearest.best.map(|(_, slots)| slots);
    let first = slots[0];
    slots[nearest.len..].fill(first);
    slots
}

/// For each child of A's node the nearest of B's.
fn children(level: Level, (a, b): (&Tree, &Tree), pair: &Entry, pairing: &Pairing, next: &mut Beam) {
    let (open_a, open_b) = pair.opens();
    let (node_a, mask_a) = lanes(a, pair.a, pair.height_a, open_a);
    let (node_b, mask_b) = lanes(b, pair.b, pair.height_b, open_b);
    let worst = next.farthest();
    let Closest { squares, partners, better } = dispatch!(level, simd => {
        let (rows, shift) = (rows16(simd, &pairing.ab.m), splat16(simd, pairing.ab.t));
        closest(simd, load16(simd, &node_a.mark), &store16(load16(simd, &node_b.mark).placed(&rows, shift)), mask_b, worst)
    });
    for i in bits(mask_a & better) {
        next.offer(squares[i], pair.child(i, partners[i] as usize, squares[i]));
    }
}

/// A node of which the children in the mask are asked about: its own, or itself as a child of its parent.
fn lanes(tree: &Tree, number: u32, height: u8, open: bool) -> (&Node, u32) {
    let (number, height) = (number as usize, height as usize);
    if open {
        (&tree.levels[height - 1][number], tree.children(height, number))
    } else {
        (&tree.levels[height][number / FAN], 1 << (number % FAN))
    }
}

fn triangles(
    level: Level,
    (a, b): (&Tree, &Tree),
    pair: &Entry,
    pairing: &Pairing,
    nearest: &mut Nearest<(u32, u32), FOUND>,
) {
    let (leaf_a, leaf_b) = (pair.a as usize, pair.b as usize);
    let (count_a, count_b) = (filling(a, leaf_a), filling(b, leaf_b));
    let worst = nearest.farthest();
    let Closest { squares, partners, better } = dispatch!(level, simd => {
        let (rows, shift) = (rows8(simd, &pairing.ab.m), splat8(simd, pairing.ab.t));
        let of_b = middles(simd, &b.leaves[leaf_b]).placed(&rows, shift);
        let nothing = splat8(simd, [0.0; 3]);
        let of_b = store16(V3(of_b.0.combine(nothing.0), of_b.1.combine(nothing.1), of_b.2.combine(nothing.2)));
        let of_a = middles(simd, &a.leaves[leaf_a]);
        let of_a = V3(of_a.0.combine(nothing.0), of_a.1.combine(nothing.1), of_a.2.combine(nothing.2));
        closest(simd, of_a, &of_b, (1 << count_b) - 1, worst)
    });
    for i in bits(better & ((1 << count_a) - 1)) {
        let slot = |leaf: usize, lane: usize| (leaf * LEAF + lane) as u32;
        nearest.offer(squares[i], (slot(leaf_a, i), slot(leaf_b, partners[i] as usize)));
    }
}

/// Middles of eight triangles.
#[inline(always)]
fn middles<S: Simd>(simd: S, leaf: &Leaf) -> V3<W8<S>> {
    let [p, q, r] = load_corners(simd, &leaf.corner);
    p.plus(q).plus(r).times(W8::splat(simd, 1.0 / 3.0))
}

/// For each of sixteen points the nearest of others: its squared distance and its number.
struct Closest {
    squares: [f32; FAN],
    partners: [f32; FAN],
    /// Bits of those that are nearer than was asked for.
    better: u32,
}

#[inline(always)]
fn closest<S: Simd>(simd: S, points: V3<W16<S>>, others: &[[f32; FAN]; 3], mask: u32, worst: f32) -> Closest {
    let mut best = W16::splat(simd, f32::INFINITY);
    let mut partner = W16::splat(simd, 0.0);
    for j in bits(mask) {
        let apart = points.minus(splat16(simd, [others[0][j], others[1][j], others[2][j]]));
        let square = apart.dot(apart);
        let nearer = square.simd_lt(best);
        best = nearer.select(square, best);
        partner = nearer.select(W16::splat(simd, j as f32), partner);
    }
    let better = best.simd_lt(worst).to_bitmask() as u32;
    let (mut squares, mut partners) = ([0.0; FAN], [0.0; FAN]);
    best.store_slice(&mut squares);
    partner.store_slice(&mut partners);
    Closest { squares, partners, better }
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
