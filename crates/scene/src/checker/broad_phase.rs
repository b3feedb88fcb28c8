//! The broad phase: the pairs that proofs and world boxes do not decide.

use super::core::{Candidate, CheckerCore};
use super::pair_list::PairList;
use crate::world_box::round_up;
use crate::{Level, SceneState};

/// More than the relative rounding error of a sum of two non-negative f32.
const ROUND_UP: f32 = 1.0 + 4.0 * f32::EPSILON;

impl CheckerCore<'_> {
    /// Collects the pairs that may not be farther apart than their margin and `tolerance` metres. With `by_robot`, one pair
    /// stands for all pairs of a robot with another robot or an object.
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

    /// Sorts the candidates by key, then by the hierarchy.
    pub(super) fn sort_candidates(&mut self) {
        if self.candidates.len() < 2 {
            return;
        }
        self.candidates.sort_unstable_by(|x, y| x.key.total_cmp(&y.key).then(x.rank.cmp(&y.rank)));
    }
}
