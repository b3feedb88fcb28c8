//! Branch and bound for the nearest pair of triangles: finds a good upper bound, then proves that all other pairs
//! are farther.

use elbowroom_spatial::Vec3;
use fearless_simd::{Simd, dispatch};

use super::cutoff::Cutoff;
use super::landmark_descent::nearest_landmark_pairs;
use super::leaf_kernel::{LeafIntervals, LeafPair, PairMask, best_partners, pairs_within};
use super::mesh_pair::MeshPair;
use super::nearest_pair::NearestPair;
use super::node_kernel::{DISTANCE, expand, expand_in};
use super::node_pair::{NodePair, NodePairStack};
use super::triangle_batch::{TriangleBatch, robust_closest_points};
use super::triangle_kernel::{BATCH, Distances};
use super::warm_start::WarmStart;
use super::workspace::{QueryStats, Workspace};
use crate::bvh::LEAF_SIZE;
use crate::triangle::ClosestPoints;

/// Increase of the distance of a warm start's triangles (units of A) above which it is replaced by a new first
/// bound.
const STALE: f64 = 0.02;

/// How a search finds its first upper bound.
#[derive(Debug, Clone, Copy)]
pub(crate) enum FirstBound {
    /// By a beam search over landmarks: the sooner a near pair is found, the fewer nodes are expanded.
    Landmarks {
        /// Number of node pairs followed at each height.
        width: usize,
    },
    /// From the first leaves of the traversal: meshes that are farther apart than the radius are dismissed soonest.
    FirstLeaves,
}

/// Settings of a search; lengths in units of A.
#[derive(Debug, Clone, Copy)]
pub(super) struct SearchSettings {
    /// Largest distance of pairs to search for.
    pub radius: f64,
    /// Distance at which the search ends: a pair no farther apart is sufficient.
    pub sufficient: f64,
    /// Largest difference between the distances of tied pairs; see [`NearestPair::spread`].
    pub tie_tolerance: f64,
    pub warm_start: WarmStart,
    pub first_bound: FirstBound,
}

struct NearestPairSearch<'a> {
    meshes: &'a MeshPair<'a>,
    settings: &'a SearchSettings,
    cutoff: Cutoff,
    radius: f64,
    /// Distance of the pair that the witness frame is aligned with.
    aligned_at: f64,
    best: Option<NearestPair>,
    batch: &'a mut TriangleBatch,
    /// A leaf of B in the witness frame, and its number.
    intervals: LeafIntervals,
    intervals_of: Option<usize>,
    slots: [(u32, u32); BATCH],
    stats: &'a mut QueryStats,
}

/// The nearest pair within the radius, or one that is sufficiently near.
pub(super) fn nearest_pair(
    meshes: &MeshPair,
    settings: &SearchSettings,
    workspace: &mut Workspace,
) -> Option<NearestPair> {
    let (mut search, stack) = NearestPairSearch::new(meshes, settings, workspace);
    stack.push(NodePair::root(&meshes.a.bvh, &meshes.b.bvh));
    search.find_first_bound(stack);
    // Selected once for the whole branch and bound, so that the kernels are inlined into it.
    dispatch!(meshes.simd_level, simd => search.branch_and_bound(simd, stack));
    search.best
}

/// The nearest of the pairs that provide the first upper bound.
pub(super) fn upper_bound_pair(
    meshes: &MeshPair,
    settings: &SearchSettings,
    workspace: &mut Workspace,
) -> Option<NearestPair> {
    let (mut search, stack) = NearestPairSearch::new(meshes, settings, workspace);
    search.find_first_bound(stack);
    search.best
}

impl<'a> NearestPairSearch<'a> {
    fn new(
        meshes: &'a MeshPair<'a>,
        settings: &'a SearchSettings,
        workspace: &'a mut Workspace,
    ) -> (Self, &'a mut NodePairStack) {
        let Workspace { stack, batch, stats, .. } = workspace;
        batch.clear();
        stack.clear();
        let mut cutoff = Cutoff::new(settings.radius, meshes.placement);
        cutoff.align(meshes.placement.map_to_a(Vec3::ZERO), meshes.placement);
        let search = Self {
            meshes,
            settings,
            cutoff,
            radius: settings.radius,
            aligned_at: f64::INFINITY,
            best: None,
            batch,
            intervals: LeafIntervals::UNKNOWN,
            intervals_of: None,
            slots: [(0, 0); BATCH],
            stats,
        };
        (search, stack)
    }

    fn find_first_bound(&mut self, stack: &mut NodePairStack) {
        let (a, b, warm) = (&self.meshes.a.bvh, &self.meshes.b.bvh, self.settings.warm_start);
        let slots_exist = warm.a < a.order.len() as u32 && warm.b < b.order.len() as u32;
        if slots_exist {
            self.measure(&[(warm.a, warm.b)]);
            let is_fresh = self.radius < f64::from(warm.distance) + STALE;
            if is_fresh || matches!(self.settings.first_bound, FirstBound::FirstLeaves) {
                return;
            }
        }
        match self.settings.first_bound {
            FirstBound::Landmarks { width } => self.measure(&nearest_landmark_pairs(self.meshes, width)),
            FirstBound::FirstLeaves => self.descend_to_leaves(stack),
        }
    }

    /// Expands the pair with the smallest bound until it reaches two leaves, and measures some of their triangles.
    fn descend_to_leaves(&mut self, stack: &mut NodePairStack) {
        while let Some(pair) = stack.pop() {
            if pair.is_leaves() {
                self.sample(LeafPair { a: pair.a as usize, b: pair.b as usize });
                // These leaves have other pairs of triangles.
                stack.push(pair);
                return;
            }
            self.expand(&pair, stack);
        }
    }

    /// Measures, for each triangle of a leaf of A, the triangle of B with the smallest lower bound: a batch of one pair
    /// costs as much as a batch of eight.
    fn sample(&mut self, leaves: LeafPair) {
        let chosen = match &self.cutoff.witness_frame {
            Some(frame) => best_partners(self.meshes, leaves, frame),
            None => leaves.all(self.meshes).first_row(),
        };
        self.queue_pairs(leaves, chosen);
        self.flush();
    }

    fn is_done(&self) -> bool {
        self.best.is_some_and(|b| b.distance <= self.settings.sufficient)
    }

    /// Measures pairs of slots at once.
    fn measure(&mut self, pairs: &[(u32, u32)]) {
        for &(slot_a, slot_b) in pairs {
            self.queue_pair(slot_a, slot_b);
        }
        self.flush();
    }

    /// Keeps the nearer pair; of equal pairs the one with the smaller indices, so that the result does not depend on the
    /// order of tests.
    fn offer(&mut self, distance: f64, points: ClosestPoints, triangles: (u32, u32), warm_start: WarmStart) {
        let mut spread = 0.0;
        if let Some(best) = &mut self.best
            && (best.distance - distance).abs() <= self.settings.tie_tolerance
        {
            best.spread += best.points.on_a.distance(points.on_a);
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
        self.best = Some(NearestPair { distance, points, triangles, warm_start, spread });
        if nearer {
            self.radius = distance;
            self.cutoff.tighten(distance, points.on_a, points.on_b, self.meshes.placement);
            self.intervals_of = None;
        }
    }

    /// Measures the batch.
    fn flush(&mut self) {
        if self.batch.is_empty() {
            return;
        }
        let MeshPair { a, b, placement, simd_level } = *self.meshes;
        let (mut found, len) = self.batch.measure(simd_level, placement);
        self.stats.triangles += len as u32;
        self.stats.batches += 1;
        if self.best.is_none() {
            self.align_witness_frame(&found, len);
        }
        // The nearest pair comes first: it may make the others irrelevant.
        while let Some(lane) = least(&found.at_least, len, self.radius + self.settings.tie_tolerance) {
            let triangles = self.batch.triangles[lane];
            let distance = found.distance[lane] as f32;
            let warm_start = WarmStart { a: self.slots[lane].0, b: self.slots[lane].1, distance };
            let certain = found.is_certain(lane);
            let points = if certain {
                found.closest_points(lane)
            } else {
                robust_closest_points(a, triangles.0 as usize, b, triangles.1 as usize, placement)
            };
            let distance = if certain { found.distance[lane] } else { points.squared.sqrt() };
            self.offer(distance, points, triangles, warm_start);
            found.at_least[lane] = f64::INFINITY;
        }
    }

    /// Aligns the witness frame with the nearest measured pair, even if it is not within the radius.
    fn align_witness_frame(&mut self, found: &Distances, len: usize) {
        if let Some(lane) = least(&found.distance, len, self.aligned_at) {
            let points = found.closest_points(lane);
            self.aligned_at = found.distance[lane];
            self.cutoff.align(points.on_b - points.on_a, self.meshes.placement);
            self.intervals_of = None;
        }
    }

    #[inline(always)]
    fn visit_leaves<S: Simd>(&mut self, simd: S, leaves: LeafPair) {
        self.stats.leaves += 1;
        if self.intervals_of != Some(leaves.b) {
            self.intervals.invalidate();
            self.intervals_of = Some(leaves.b);
        }
        let left = pairs_within(simd, self.meshes, leaves, &self.cutoff, &mut self.intervals);
        self.queue_pairs(leaves, left);
    }

    /// Adds pairs to the batch, and measures it whenever it is full.
    fn queue_pairs(&mut self, leaves: LeafPair, pairs: PairMask) {
        for (i, j) in pairs.lanes() {
            self.queue_pair(leaves.a as u32 * LEAF_SIZE as u32 + i, leaves.b as u32 * LEAF_SIZE as u32 + j);
        }
    }

    fn queue_pair(&mut self, slot_a: u32, slot_b: u32) {
        self.slots[self.batch.len()] = (slot_a, slot_b);
        if self.batch.push(self.meshes.a, slot_a, self.meshes.b, slot_b) {
            self.flush();
        }
    }

    fn expand(&mut self, pair: &NodePair, stack: &mut NodePairStack) {
        self.stats.nodes += 1;
        self.stats.boxes += expand::<DISTANCE>(self.meshes, pair, &self.cutoff, stack);
    }

    /// Expands every pair of nodes that may be nearer than the best pair.
    #[inline(always)]
    fn branch_and_bound<S: Simd>(&mut self, simd: S, stack: &mut NodePairStack) {
        while let Some(pair) = stack.pop() {
            if self.is_done() {
                return;
            }
            if pair.key > self.cutoff.squared {
                continue;
            }
            if pair.is_leaves() {
                self.visit_leaves(simd, LeafPair { a: pair.a as usize, b: pair.b as usize });
            } else {
                self.stats.nodes += 1;
                let expanded = pair.expanded_sides();
                self.stats.boxes += expand_in::<_, DISTANCE>(simd, self.meshes, &pair, expanded, &self.cutoff, stack);
            }
        }
        self.flush();
    }
}

/// The lane of the smallest number not larger than `limit`. A NaN, which means unknown, comes first.
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
