//! Everything near: each pair within a margin, measured.

use super::answer::Distance;
use super::list::PairList;
use super::nearest::less_margin;
use super::{Candidate, Core};
use crate::{Level, SceneState};

impl Core<'_> {
    /// Every pair that is not certainly farther apart than its margin and `within` metres, in the order of the hierarchy.
    pub(super) fn near(
        &mut self,
        list: &mut PairList,
        state: &SceneState,
        within: f64,
        mut found: impl FnMut(Distance),
    ) {
        // A robot as a whole is no pair: L1 is answered at L2.
        self.collect(list, state, within, false);
        self.sort();
        for i in 0..self.candidates.len() {
            let Candidate { index, .. } = self.candidates[i];
            if let Some(distance) = self.within(list, index as usize, state, within) {
                found(distance);
            }
        }
        self.narrow.counts.answered.add(self.deepest, 1);
    }

    /// One pair, from coarse to fine, no farther than `within` metres beyond its margin.
    fn within(&mut self, list: &mut PairList, index: usize, state: &SceneState, within: f64) -> Option<Distance> {
        let pair = &mut list.pairs[index];
        let [a, b] = self.sides(pair, state);
        let level = self.fine();
        let margin = pair.margin + a.model.slack(level) + b.model.slack(level);
        let limit = margin + within;
        if self.options.level == Level::Auto
            && self.boxes_decide()
            && limit < f64::INFINITY
            && let Some(level) = self.narrow.cleared_coarsely(&a, &b, limit)
        {
            self.narrow.counts.pairs_cleared.add(level, 1);
            self.deepen(level);
            return None;
        }
        self.deepen(level);
        let Some(s) = self.narrow.measure(&a, &b, level, limit, &mut pair.hint) else {
            self.narrow.counts.pairs_cleared.add(level, 1);
            return None;
        };
        // What was proven of the exact solids may be more than what enclosing volumes can tell.
        let proven = (self.known(pair, state) - pair.margin).max(0.0);
        let (metres, lower) = less_margin(&s, margin);
        let (metres, lower_bound) = (metres.max(proven), lower.max(proven));
        let (a, b) = (a.model.member, b.model.member);
        (lower_bound <= within).then_some(Distance { metres, lower_bound, on_a: s.on_a, on_b: s.on_b, a, b, level })
    }
}
