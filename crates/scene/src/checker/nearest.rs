//! Which pair is nearest: one running upper bound over all pairs.

use elbowroom_proximity::Separation;

use super::answer::Distance;
use super::list::PairList;
use super::{Candidate, Core};
use crate::{Level, SceneState};

/// So many of the likeliest pairs are guessed at before any is measured.
const GUESSES: usize = 2;

impl Core<'_> {
    /// The nearest pair; `None` where there is none.
    pub(super) fn nearest(&mut self, list: &mut PairList, state: &SceneState) -> Option<Distance> {
        self.deepest = Level::L1;
        self.guessed = f64::INFINITY;
        let mut best: Option<Distance> = None;
        // What was nearest is likely to be nearest again, and gives the others a limit.
        let mut last = list.nearest.filter(|_| self.options.level != Level::L1);
        if let Some(index) = last {
            if self.guess(list, index, state) {
                last = None;
            } else {
                self.look(list, index, state, &mut best);
            }
        }
        self.bound(list, state, &mut best, last);
        self.sort();
        for i in 0..self.candidates.len().min(GUESSES) {
            self.guess(list, self.candidates[i].index as usize, state);
        }
        for i in 0..self.candidates.len() {
            let Candidate { key, index, .. } = self.candidates[i];
            if self.beyond(key, best.as_ref()) {
                self.narrow.counts.pairs_cleared.l2 += (self.candidates.len() - i) as u64;
                break;
            }
            self.look(list, index as usize, state, &mut best);
        }
        self.narrow.counts.answered.add(self.deepest, 1);
        best
    }

    /// True where a pair at least so far apart cannot be the nearest.
    fn beyond(&self, metres: f64, best: Option<&Distance>) -> bool {
        metres > self.guessed || best.is_some_and(|b| metres >= b.metres)
    }

    /// Looks for an upper bound of the distance at one pair; false where there is none to be had.
    fn guess(&mut self, list: &mut PairList, index: usize, state: &SceneState) -> bool {
        if !matches!(self.options.level, Level::Auto | Level::L3) {
            return false;
        }
        let pair = &mut list.pairs[index];
        let [a, b] = self.sides(pair, state);
        let Some(metres) = self.narrow.guess(&a, &b, &mut pair.hint) else { return false };
        self.guessed = self.guessed.min((metres - pair.margin).max(0.0));
        true
    }

    /// Collects the pairs that boxes leave in question, with the bounds that they give.
    fn bound(&mut self, list: &PairList, state: &SceneState, best: &mut Option<Distance>, last: Option<usize>) {
        self.candidates.clear();
        let (boxes, wholes) = (self.boxes_decide(), self.wholes_decide());
        for block in &list.blocks {
            let same = block.a == block.b;
            if wholes && !same {
                let gap = f64::from(state.boxes[block.a].gap(&state.boxes[block.b])) - block.margin;
                if self.options.level == Level::L1 {
                    self.whole(list, block, state, best);
                    continue;
                }
                if self.beyond(gap, best.as_ref()) {
                    self.narrow.counts.pairs_cleared.l1 += (block.end - block.start) as u64;
                    continue;
                }
            }
            for index in (block.start..block.end).filter(|i| Some(*i) != last) {
                let sides = &list.sides[index];
                let known = if sides.proven { self.known(&list.pairs[index], state) } else { 0.0 };
                if known == f64::INFINITY {
                    self.narrow.counts.pairs_skipped += 1;
                    continue;
                }
                let gap = if boxes {
                    f64::from(state.boxes[sides.a as usize].gap(&state.boxes[sides.b as usize]))
                } else {
                    0.0
                };
                let key = (gap.max(known) - f64::from(sides.margin)).max(0.0);
                if self.beyond(key, best.as_ref()) {
                    self.narrow.counts.pairs_cleared.l2 += 1;
                    self.deepen(Level::L2);
                    continue;
                }
                self.candidates.push(Candidate { key, rank: list.pairs[index].rank, index: index as u32 });
            }
        }
    }

    /// The box of a robot against that of another or of an object.
    fn whole(&mut self, list: &PairList, block: &super::list::Block, state: &SceneState, best: &mut Option<Distance>) {
        let (a, b) = (&state.boxes[block.a], &state.boxes[block.b]);
        let (on_a, on_b) = a.nearest(b);
        let gap = f64::from(a.gap(b));
        let Some(pair) = list.pairs[block.start..block.end].iter().find(|p| self.known(p, state) < f64::INFINITY)
        else {
            return;
        };
        let metres = (gap - block.margin).max(0.0);
        if best.is_none_or(|b| metres < b.metres) {
            let [x, y] = self.sides(pair, state).map(|p| p.model.member);
            // The block's order is by box, the pair's by member.
            let swapped = state.carrier(x).map_or(pair.a as usize, |(r, _)| self.scene.models.len() + r) != block.a;
            let (on_a, on_b) = if swapped { (on_b, on_a) } else { (on_a, on_b) };
            *best = Some(Distance { metres, lower_bound: metres, on_a, on_b, a: x, b: y, level: Level::L1 });
        }
    }

    /// Looks at one pair, no farther than the best so far.
    fn look(&mut self, list: &mut PairList, index: usize, state: &SceneState, best: &mut Option<Distance>) {
        let pair = &mut list.pairs[index];
        let [a, b] = self.sides(pair, state);
        // What was proven of the exact solids may be more than what enclosing volumes can tell.
        let proven = (self.known(pair, state) - pair.margin).max(0.0);
        let slack = a.model.slack(self.options.level) + b.model.slack(self.options.level);
        let margin = pair.margin + slack;
        let limit = best.map_or(self.guessed, |b| b.metres.min(self.guessed)) + margin;
        if self.options.level == Level::Auto
            && self.boxes_decide()
            && limit < f64::INFINITY
            && let Some(level) = self.narrow.cleared_coarsely(&a, &b, limit)
        {
            self.narrow.counts.pairs_cleared.add(level, 1);
            self.deepen(level);
            return;
        }
        let level = self.fine();
        self.deepen(level);
        let Some(s) = self.narrow.measure(&a, &b, level, limit, &mut pair.hint) else {
            self.narrow.counts.pairs_cleared.add(level, 1);
            return;
        };
        let (metres, lower) = less_margin(&s, margin);
        let found = (metres.max(proven), lower.max(proven));
        let lower_bound = best.map_or(found.1, |b| b.lower_bound.min(found.1));
        if best.is_none_or(|b| found.0 < b.metres) {
            list.nearest = Some(index);
            let (a, b) = (a.model.member, b.model.member);
            *best = Some(Distance { metres: found.0, lower_bound, on_a: s.on_a, on_b: s.on_b, a, b, level });
        } else if let Some(best) = best {
            best.lower_bound = lower_bound;
        }
    }
}

/// Distance and proven lower bound between padded solids.
pub(super) fn less_margin(s: &Separation, margin: f64) -> (f64, f64) {
    if margin == 0.0 {
        return (s.distance, s.lower_bound);
    }
    let lower = s.lower_bound - margin - f64::EPSILON * (s.lower_bound + margin);
    ((s.distance - margin).max(0.0), lower.max(0.0))
}
