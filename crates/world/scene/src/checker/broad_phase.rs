//! The broad phase: selects the pairs that proofs and world boxes leave undecided.
//!
//! [`broad_phase`](CheckerCore::broad_phase) compares boxes by a known tolerance. Collision and tolerance queries, all
//! contacts, collision points, distances within a margin and approaching pairs use it.
//! [`broad_phase_by_gap`](CheckerCore::broad_phase_by_gap) orders pairs by the gaps of their boxes. The minimum distance
//! uses it: its limit decreases while pairs are measured. Sweeps use their own search (`sweep/search.rs`).

use super::core::{Candidate, CheckerCore};
use super::pair_list::PairList;
use super::result::PairDistance;
use crate::world_box::round_up;
use crate::{Level, SceneState};

/// Factor that exceeds the relative rounding error of a sum of two non-negative f32.
const ROUND_UP: f32 = 1.0 + 4.0 * f32::EPSILON;

impl CheckerCore<'_> {
    /// Collects the pairs that may be within their margin plus `tolerance` metres.
    ///
    /// With `by_robot`, one pair represents all pairs of a robot with another robot or an object.
    pub(super) fn broad_phase(&mut self, list: &PairList, state: &SceneState, tolerance: f64, by_robot: bool) {
        self.candidates.clear();
        self.finest = Level::L1;
        let (boxes, robot_boxes) = (self.options.uses_boxes(), self.options.uses_robot_boxes());
        let rounded_tolerance = round_up(tolerance);
        let (mut skipped, mut cleared) = (0, 0);
        for block in &list.blocks {
            let margin = round_up(block.margin + tolerance);
            let same = block.a == block.b;
            if robot_boxes && !same && state.boxes[block.a].separated(&state.boxes[block.b], margin) {
                self.narrow.stats.pairs_cleared.l1 += (block.end - block.start) as u64;
                continue;
            }
            let coarse = by_robot && !same;
            for (i, packed) in list.packed[block.start..block.end].iter().enumerate() {
                let index = block.start + i;
                let pair = &list.pairs[index];
                if packed.proven && self.proven_distance(pair, state) > pair.margin + tolerance {
                    skipped += 1;
                    continue;
                }
                let (a, b) = (&state.boxes[packed.a as usize], &state.boxes[packed.b as usize]);
                if boxes && !coarse && a.separated(b, (packed.margin + rounded_tolerance) * ROUND_UP) {
                    cleared += 1;
                    continue;
                }
                self.candidates.push(Candidate { key: 0.0, rank: pair.rank, index: index as u32 });
                if coarse {
                    break;
                }
            }
        }
        self.narrow.stats.pairs_skipped += skipped;
        self.narrow.stats.pairs_cleared.l2 += cleared;
        if cleared > 0 {
            self.used(Level::L2);
        }
    }

    /// Collects the pairs that may be nearer than the best pair so far.
    ///
    /// Their keys are the gaps of their world boxes or their proven least distances. `last` is the pair that is measured
    /// already. Pairs at [`Level::L1`] are measured at once.
    pub(super) fn broad_phase_by_gap(
        &mut self,
        list: &PairList,
        state: &SceneState,
        best: &mut Option<PairDistance>,
        last: Option<usize>,
    ) {
        self.candidates.clear();
        let (boxes, robot_boxes) = (self.options.uses_boxes(), self.options.uses_robot_boxes());
        for block in &list.blocks {
            let same = block.a == block.b;
            if robot_boxes && !same {
                let gap = f64::from(state.boxes[block.a].gap(&state.boxes[block.b])) - block.margin;
                if self.options.level == Level::L1 {
                    self.measure_robot_boxes(list, block, state, best);
                    continue;
                }
                if self.exceeds_best(gap, best.as_ref()) {
                    self.narrow.stats.pairs_cleared.l1 += (block.end - block.start) as u64;
                    continue;
                }
            }
            for index in (block.start..block.end).filter(|i| Some(*i) != last) {
                let packed = &list.packed[index];
                let proven = if packed.proven { self.proven_distance(&list.pairs[index], state) } else { 0.0 };
                if proven == f64::INFINITY {
                    self.narrow.stats.pairs_skipped += 1;
                    continue;
                }
                let gap = if boxes {
                    f64::from(state.boxes[packed.a as usize].gap(&state.boxes[packed.b as usize]))
                } else {
                    0.0
                };
                let key = (gap.max(proven) - f64::from(packed.margin)).max(0.0);
                if self.exceeds_best(key, best.as_ref()) {
                    self.cleared(Level::L2);
                    continue;
                }
                self.candidates.push(Candidate { key, rank: list.pairs[index].rank, index: index as u32 });
            }
        }
    }

    /// Sorts the candidates by key, then by their order in the hierarchy.
    pub(super) fn sort_candidates(&mut self) {
        if self.candidates.len() < 2 {
            return;
        }
        self.candidates.sort_unstable_by(|x, y| x.key.total_cmp(&y.key).then(x.rank.cmp(&y.rank)));
    }
}
