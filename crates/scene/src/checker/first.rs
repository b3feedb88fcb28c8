//! Is anything in contact: yes or no, and who.

use super::answer::Contact;
use super::list::{Pair, PairList};
use super::narrow::Placed;
use super::{Candidate, Core};
use crate::world_box::round_up;
use crate::{Level, SceneState};

/// More than the rounding of a sum of two f32 that are not negative.
const ROUND_UP: f32 = 1.0 + 4.0 * f32::EPSILON;

impl<'s> Core<'s> {
    /// A pair that is not farther apart than its margin and `tolerance` metres.
    pub(super) fn first(&mut self, list: &mut PairList, state: &SceneState, tolerance: f64) -> Option<Contact> {
        self.collect(list, state, tolerance, self.options.level == Level::L1);
        if self.options.weights {
            for c in &mut self.candidates {
                c.key = -list.pairs[c.index as usize].weight;
            }
        }
        self.sort();
        let mut found = None;
        for i in 0..self.candidates.len() {
            let pair = &mut list.pairs[self.candidates[i].index as usize];
            found = self.hit(pair, state, tolerance);
            if found.is_some() {
                if self.options.weights {
                    list.learn(self.candidates[i].index as usize);
                }
                break;
            }
        }
        self.narrow.counts.answered.add(self.deepest, 1);
        found
    }

    /// Every pair in contact.
    pub(super) fn all(&mut self, list: &mut PairList, state: &SceneState, mut found: impl FnMut(Contact)) {
        self.collect(list, state, 0.0, self.options.level == Level::L1);
        self.sort();
        for i in 0..self.candidates.len() {
            let pair = &mut list.pairs[self.candidates[i].index as usize];
            if let Some(contact) = self.hit(pair, state, 0.0) {
                found(contact);
            }
        }
        self.narrow.counts.answered.add(self.deepest, 1);
    }

    pub(super) fn sides(&self, pair: &Pair, state: &SceneState) -> [Placed<'s>; 2] {
        [pair.a, pair.b].map(|model| Placed::new(self.scene, state, model as usize))
    }

    pub(super) fn sort(&mut self) {
        if self.candidates.len() < 2 {
            return;
        }
        self.candidates.sort_unstable_by(|x, y| x.key.total_cmp(&y.key).then(x.rank.cmp(&y.rank)));
    }

    /// The level at which pairs are looked at one by one.
    pub(crate) fn fine(&self) -> Level {
        match self.options.level {
            Level::Auto => Level::L3,
            Level::L1 => Level::L2,
            level => level,
        }
    }

    pub(crate) fn deepen(&mut self, level: Level) {
        self.deepest = self.deepest.max(level);
    }

    /// True where pairs may be dismissed by boxes: their answer would be the same.
    pub(crate) fn boxes_decide(&self) -> bool {
        match self.options.level {
            Level::Auto => self.options.start <= Level::L2,
            Level::L1 | Level::L2 | Level::Hull => true,
            // A capsule may stick out of the box.
            Level::Capsule | Level::L3 => false,
        }
    }

    /// True where robots may be dismissed as a whole.
    pub(super) fn wholes_decide(&self) -> bool {
        match self.options.level {
            Level::Auto => self.options.start <= Level::L1,
            level => level == Level::L1,
        }
    }

    /// Metres that the pair is certainly apart by what the matrix knows.
    pub(super) fn known(&self, pair: &Pair, state: &SceneState) -> f64 {
        let side = |model: u32| state.proofs_hold(self.scene.models[model as usize].member);
        let holds =
            pair.least > 0.0 && self.options.matrix && (state.all_proofs_hold || (side(pair.a) && side(pair.b)));
        if holds { pair.least } else { 0.0 }
    }

    /// Pairs that boxes do not dismiss. With `by_robot`, one pair stands for all of a robot against another or an object.
    pub(super) fn collect(&mut self, list: &PairList, state: &SceneState, tolerance: f64, by_robot: bool) {
        self.candidates.clear();
        self.deepest = Level::L1;
        let (boxes, wholes) = (self.boxes_decide(), self.wholes_decide());
        let reach = round_up(tolerance);
        let (mut skipped, mut cleared) = (0, 0);
        for block in &list.blocks {
            let margin = round_up(block.margin + tolerance);
            let same = block.a == block.b;
            if wholes && !same && state.boxes[block.a].clear(&state.boxes[block.b], margin) {
                self.narrow.counts.pairs_cleared.l1 += (block.end - block.start) as u64;
                continue;
            }
            let coarse = by_robot && !same;
            for (i, sides) in list.sides[block.start..block.end].iter().enumerate() {
                let index = block.start + i;
                if sides.proven && self.known(&list.pairs[index], state) > list.pairs[index].margin + tolerance {
                    skipped += 1;
                    continue;
                }
                let (a, b) = (&state.boxes[sides.a as usize], &state.boxes[sides.b as usize]);
                if boxes && !coarse && a.clear(b, (sides.margin + reach) * ROUND_UP) {
                    cleared += 1;
                    continue;
                }
                self.candidates.push(Candidate { key: 0.0, rank: list.pairs[index].rank, index: index as u32 });
                if coarse {
                    break;
                }
            }
        }
        self.narrow.counts.pairs_skipped += skipped;
        self.narrow.counts.pairs_cleared.l2 += cleared;
        if cleared > 0 {
            self.deepen(Level::L2);
        }
    }

    /// Looks at one pair, from coarse to fine.
    fn hit(&mut self, pair: &mut Pair, state: &SceneState, tolerance: f64) -> Option<Contact> {
        let limit = pair.margin + tolerance;
        let [a, b] = self.sides(pair, state);
        let contact = |level| Some(Contact { a: a.model.member, b: b.model.member, level });
        let carriers = [a, b].map(|p| state.carrier(p.model.member).map(|c| c.0));
        if self.options.level == Level::L1 && (carriers[0] != carriers[1] || carriers[0].is_none()) {
            return contact(Level::L1);
        }
        if self.options.level == Level::Auto
            && self.boxes_decide()
            && let Some(level) = self.narrow.cleared_coarsely(&a, &b, limit)
        {
            self.narrow.counts.pairs_cleared.add(level, 1);
            self.deepen(level);
            return None;
        }
        let level = self.fine();
        self.deepen(level);
        let limit = limit + a.model.slack(level) + b.model.slack(level);
        if self.narrow.touch(&a, &b, level, limit) {
            return contact(level);
        }
        self.narrow.counts.pairs_cleared.add(level, 1);
        None
    }
}
