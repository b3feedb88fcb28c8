//! Collision and tolerance queries: whether a pair is in contact, and which pair.

use super::core::CheckerCore;
use super::pair_list::{GeometryPair, PairList};
use super::result::PairContact;
use crate::{Level, SceneState};

impl CheckerCore<'_> {
    /// Finds a pair that is at most its margin plus `tolerance` metres apart.
    pub(super) fn first_contact(
        &mut self,
        list: &mut PairList,
        state: &SceneState,
        tolerance: f64,
    ) -> Option<PairContact> {
        self.broad_phase(list, state, tolerance, self.options.level == Level::L1);
        if self.options.weights {
            for c in &mut self.candidates {
                c.key = -list.pairs[c.index as usize].weight;
            }
        }
        self.sort_candidates();
        let mut found = None;
        for i in 0..self.candidates.len() {
            let index = self.candidates[i].index as usize;
            found = self.contact(&list.pairs[index], state, tolerance);
            if found.is_some() {
                if self.options.weights {
                    list.learn(index);
                }
                break;
            }
        }
        self.answered();
        found
    }

    /// Reports every pair in contact.
    pub(super) fn all_contacts(&mut self, list: &PairList, state: &SceneState, mut found: impl FnMut(PairContact)) {
        self.broad_phase(list, state, 0.0, self.options.level == Level::L1);
        self.sort_candidates();
        for i in 0..self.candidates.len() {
            let pair = &list.pairs[self.candidates[i].index as usize];
            if let Some(contact) = self.contact(pair, state, 0.0) {
                found(contact);
            }
        }
        self.answered();
    }

    /// Tests one pair, from coarse to fine.
    fn contact(&mut self, pair: &GeometryPair, state: &SceneState, tolerance: f64) -> Option<PairContact> {
        let limit = pair.margin + tolerance;
        let sides = self.sides(pair, state);
        let [a, b] = sides;
        let contact = |level| Some(PairContact { a: a.model.id, b: b.model.id, level });
        let carriers = [a, b].map(|p| state.carrier(p.model.id).map(|c| c.0));
        if self.options.level == Level::L1 && (carriers[0] != carriers[1] || carriers[0].is_none()) {
            return contact(Level::L1);
        }
        if self.cleared_coarsely(&sides, limit) {
            return None;
        }
        let level = self.options.pair_level();
        self.used(level);
        let limit = limit + a.model.slack_m(level) + b.model.slack_m(level);
        if self.narrow.within(&a, &b, level, limit) {
            return contact(level);
        }
        self.narrow.stats.pairs_cleared.add(level, 1);
        None
    }
}
