//! Distances of all pairs within a margin.

use super::core::CheckerCore;
use super::pair_list::PairList;
use super::result::PairDistance;
use crate::SceneState;

impl CheckerCore<'_> {
    /// Reports every pair that may be within its margin plus `within` (m), in the order of the hierarchy.
    pub(super) fn distances_within(
        &mut self,
        list: &mut PairList,
        state: &SceneState,
        within: f64,
        mut found: impl FnMut(PairDistance),
    ) {
        // A robot as a whole forms no pair, so L1 is answered at L2.
        self.broad_phase(list, state, within, false);
        self.sort_candidates();
        let level = self.options.pair_level();
        for i in 0..self.candidates.len() {
            let pair = &mut list.pairs[self.candidates[i].index as usize];
            let sides = self.sides(pair, state);
            let margin = pair.margin + sides[0].model.slack_m(level) + sides[1].model.slack_m(level);
            let distance = self.pair_distance(pair, &sides, state, margin, margin + within);
            if let Some(distance) = distance.filter(|d| d.lower_bound <= within) {
                found(distance);
            }
        }
        self.answered();
    }
}
