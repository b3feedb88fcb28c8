//! The nearest pair of triangles: first a good upper bound, then the proof that nothing is nearer.

use elbowroom_spatial::Vec3;
use fearless_simd::Level;

use super::approach::promising;
use super::exact::{BATCH, Distances};
use super::leaf::{Facing, filled, near, nearest};
use super::limit::Limit;
use super::nearest::Hint;
use super::node::{NEAR, open};
use super::placement::Pairing;
use super::scratch::{Entry, Queue, Scratch, Stack, Visits, filling, settle};
use super::tree::LEAF;
use crate::TriMesh;
use crate::triangle::Near;

/// A hint whose triangles are farther apart by so much now (units of A) has become a bad beginning.
const STALE: f64 = 0.02;

/// Where the search begins.
#[derive(Debug, Clone, Copy)]
pub(super) enum Start {
    /// Where the surfaces seem nearest, with so many pairs of nodes in view.
    Landmarks(usize),
    /// At the first leaves that the descent meets.
    Descent,
}

/// The best so far, units of A.
#[derive(Clone, Copy)]
pub(super) struct Best {
    pub distance: f64,
    pub near: Near,
    pub triangles: (u32, u32),
    pub hint: Hint,
    /// Points of pairs as near to within the grain were seen as far from the best's as this, at least.
    pub spread: f64,
}

struct Search<'a> {
    level: Level,
    a: &'a TriMesh,
    b: &'a TriMesh,
    pairing: &'a Pairing,
    limit: Limit,
    radius: f64,
    /// Nearer makes no difference: the search ends.
    enough: f64,
    /// Pairs that are farther than the best by no more are noticed.
    grain: f64,
    /// Distance of the pair along which gaps are measured.
    seen: f64,
    best: Option<Best>,
    queue: &'a mut Queue,
    /// A leaf of B along the line of sight, and its number.
    facing: Facing,
    faced: Option<usize>,
    slots: [(u32, u32); BATCH],
    visits: &'a mut Visits,
}

/// Looks for the nearest pair within `radius`, until one is within `enough`; tells whether others, elsewhere, are as near to
/// within `grain`.
pub(super) fn search(
    level: Level,
    a: &TriMesh,
    b: &TriMesh,
    pairing: &Pairing,
    (radius, enough, grain): (f64, f64, f64),
    (hint, start): (Option<Hint>, Start),
    scratch: &mut Scratch,
) -> Option<Best> {
    let (mut s, stack) = Search::new(level, a, b, pairing, (radius, enough), scratch);
    s.grain = grain;
    stack.push(Entry::root(&a.tree, &b.tree));
    s.begin(hint, start, stack);
    s.prove(stack);
    s.best
}

/// The nearest of the pairs that a search begins with.
pub(super) fn promising_pair(
    level: Level,
    a: &TriMesh,
    b: &TriMesh,
    pairing: &Pairing,
    (hint, start): (Option<Hint>, Start),
    scratch: &mut Scratch,
) -> Option<Best> {
    let (mut s, stack) = Search::new(level, a, b, pairing, (f64::INFINITY, pairing.slack), scratch);
    s.begin(hint, start, stack);
    s.best
}

impl<'a> Search<'a> {
    fn new(
        level: Level,
        a: &'a TriMesh,
        b: &'a TriMesh,
        pairing: &'a Pairing,
        (radius, enough): (f64, f64),
        scratch: &'a mut Scratch,
    ) -> (Self, &'a mut Stack) {
        let Scratch { stack, queue, visits, .. } = scratch;
        queue.clear();
        stack.clear();
        let mut limit = Limit::new(radius, pairing);
        limit.look_along(pairing.in_a(Vec3::ZERO), pairing);
        let (seen, slots, facing) = (f64::INFINITY, [(0, 0); BATCH], Facing::NOTHING);
        let (best, faced) = (None, None);
        let grain = 0.0;
        (
            Self {
                level,
                a,
                b,
                pairing,
                limit,
                radius,
                enough,
                grain,
                seen,
                best,
                queue,
                facing,
                faced,
                slots,
                visits,
            },
            stack,
        )
    }
}

impl Search<'_> {
    /// Looks for a good upper bound.
    fn begin(&mut self, hint: Option<Hint>, start: Start, stack: &mut Stack) {
        if let Some(h) = hint.filter(|h| h.a < self.a.tree.order.len() as u32 && h.b < self.b.tree.order.len() as u32) {
            self.measure(&[(h.a, h.b)]);
            if self.radius < f64::from(h.distance) + STALE || matches!(start, Start::Descent) {
                return;
            }
        }
        match start {
            Start::Landmarks(width) => {
                self.measure(&promising(self.level, &self.a.tree, &self.b.tree, self.pairing, width));
            }
            Start::Descent => self.dive(stack),
        }
    }

    /// Opens what looks nearest until a leaf of each is reached, and measures what looks nearest there.
    fn dive(&mut self, stack: &mut Stack) {
        while let Some(pair) = stack.pop() {
            if pair.is_leaves() {
                self.sample(pair.a as usize, pair.b as usize);
                // There are others in these leaves.
                stack.push(pair);
                return;
            }
            self.open(&pair, stack);
        }
    }

    /// Measures, for each triangle of a leaf of A, the one of B that looks nearest: a batch costs as much for one pair as
    /// for eight.
    fn sample(&mut self, leaf_a: usize, leaf_b: usize) {
        let (a, b) = (&self.a.tree, &self.b.tree);
        let all = filled(filling(a, leaf_a), filling(b, leaf_b));
        let (of_a, of_b) = (&a.leaves[leaf_a], &b.leaves[leaf_b]);
        let chosen = self.limit.sight.map_or(all.0 & 0xff, |sight| nearest(self.level, of_a, of_b, &sight, all));
        self.queue_pairs(leaf_a, leaf_b, chosen);
        self.flush();
    }

    fn done(&self) -> bool {
        self.best.is_some_and(|b| b.distance <= self.enough)
    }

    /// Measures pairs of slots at once.
    fn measure(&mut self, pairs: &[(u32, u32)]) {
        for &(slot_a, slot_b) in pairs {
            self.queue_pair(slot_a, slot_b);
        }
        self.flush();
    }

    /// Keeps the nearer; of equals the one with the smaller numbers, so that no order of tests shows.
    fn offer(&mut self, distance: f64, near: Near, triangles: (u32, u32), hint: Hint) {
        let mut spread = 0.0;
        if let Some(best) = &mut self.best
            && (best.distance - distance).abs() <= self.grain
        {
            best.spread += best.near.on_a.distance(near.on_a);
            spread = best.spread;
        }
        if !(distance <= self.radius) {
            return;
        }
        if let Some(best) = &self.best
            && (best.distance, best.triangles) <= (distance, triangles)
        {
            return;
        }
        let nearer = self.best.is_none_or(|b| distance < b.distance);
        self.best = Some(Best { distance, near, triangles, hint, spread });
        if nearer {
            self.radius = distance;
            self.limit.tighten(distance, near.on_a, near.on_b, self.pairing);
            self.faced = None;
        }
    }

    /// Measures the queue.
    fn flush(&mut self) {
        if self.queue.is_empty() {
            return;
        }
        let (mut found, len) = self.queue.measure(self.level, self.pairing);
        self.visits.triangles += len as u32;
        self.visits.batches += 1;
        // The nearest first: it may spare the others.
        if self.best.is_none() {
            self.look(&found, len);
        }
        while let Some(lane) = least(&found.at_least, len, self.radius + self.grain) {
            let triangles = self.queue.triangles[lane];
            let distance = found.distance[lane] as f32;
            let hint = Hint { a: self.slots[lane].0, b: self.slots[lane].1, distance };
            let certain = found.at_least[lane] >= found.distance[lane];
            let near = if certain {
                found.near(lane)
            } else {
                settle(self.a, triangles.0 as usize, self.b, triangles.1 as usize, self.pairing)
            };
            self.offer(if certain { found.distance[lane] } else { near.squared.sqrt() }, near, triangles, hint);
            found.at_least[lane] = f64::INFINITY;
        }
    }

    /// Turns the line of sight to the nearest pair measured, though it is not near enough.
    fn look(&mut self, found: &Distances, len: usize) {
        if let Some(lane) = least(&found.distance, len, self.seen) {
            let near = found.near(lane);
            self.seen = found.distance[lane];
            self.limit.look_along(near.on_b - near.on_a, self.pairing);
            self.faced = None;
        }
    }

    fn leaves(&mut self, leaf_a: usize, leaf_b: usize) {
        self.visits.leaves += 1;
        let (a, b) = (&self.a.tree, &self.b.tree);
        let all = filled(filling(a, leaf_a), filling(b, leaf_b));
        if self.faced != Some(leaf_b) {
            self.facing.forget();
            self.faced = Some(leaf_b);
        }
        let (of_a, of_b) = (&a.leaves[leaf_a], &b.leaves[leaf_b]);
        let left = near(self.level, of_a, of_b, self.pairing, &self.limit, &mut self.facing, all);
        self.queue_pairs(leaf_a, leaf_b, left);
    }

    /// Puts pairs (bit `8 i + j`) in the queue, and measures it whenever it is full.
    fn queue_pairs(&mut self, leaf_a: usize, leaf_b: usize, mut pairs: u64) {
        while pairs != 0 {
            let bit = pairs.trailing_zeros();
            pairs &= pairs - 1;
            self.queue_pair(leaf_a as u32 * LEAF as u32 + bit / 8, leaf_b as u32 * LEAF as u32 + bit % 8);
        }
    }

    fn queue_pair(&mut self, slot_a: u32, slot_b: u32) {
        self.slots[self.queue.len()] = (slot_a, slot_b);
        if self.queue.push(self.a, slot_a, self.b, slot_b) {
            self.flush();
        }
    }

    fn open(&mut self, pair: &Entry, stack: &mut Stack) {
        self.visits.nodes += 1;
        let trees = (&self.a.tree, &self.b.tree);
        self.visits.boxes += open::<NEAR>(self.level, trees, pair, self.pairing, &self.limit, stack);
    }

    /// Opens every pair of nodes that may be nearer than the best.
    fn prove(&mut self, stack: &mut Stack) {
        while let Some(pair) = stack.pop() {
            if self.done() {
                return;
            }
            if pair.key > self.limit.squared {
                continue;
            }
            if pair.is_leaves() {
                self.leaves(pair.a as usize, pair.b as usize);
            } else {
                self.open(&pair, stack);
            }
        }
        self.flush();
    }
}

/// The lane of the smallest number no larger than `limit`; a NaN, of which nothing is known, comes first.
#[inline(always)]
fn least(numbers: &[f64; BATCH], len: usize, limit: f64) -> Option<usize> {
    let mut best = None;
    let mut smallest = limit;
    for (lane, &x) in numbers.iter().enumerate().take(len) {
        if x.is_nan() {
            return Some(lane);
        }
        if x < smallest || (x == smallest && best.is_none()) {
            (best, smallest) = (Some(lane), x);
        }
    }
    best
}
