//! The minimum distance: one decreasing upper bound over all pairs.

use super::core::{Candidate, CheckerCore};
use super::pair_list::{CarrierBlock, GeometryPair, PairList};
use super::result::PairDistance;
use crate::{Level, SceneState};

/// Number of nearest candidates whose upper bounds are computed before any candidate is measured.
const UPPER_BOUNDS: usize = 2;

impl CheckerCore<'_> {
    /// Finds the nearest pair; `None` if the list is empty.
    pub(super) fn minimum_distance(&mut self, list: &mut PairList, state: &SceneState) -> Option<PairDistance> {
        self.finest = Level::L1;
        self.upper_bound = f64::INFINITY;
        let mut best: Option<PairDistance> = None;
        // The nearest pair of the last query is likely to be nearest again, and gives a limit for the other pairs, unless it
        // does not count in this state.
        let counts = |pair: &GeometryPair| self.proven_distance(pair, state) < f64::INFINITY;
        let last = list.nearest.filter(|index| self.options.level != Level::L1 && counts(&list.pairs[*index]));
        let bounded = last.filter(|index| self.tighten_upper_bound(list, *index, state));
        let measured = last.filter(|_| bounded.is_none());
        if let Some(index) = measured {
            self.measure(list, index, state, &mut best, false);
        }
        // Among equally near pairs it stays the nearest. Pairs of two meshes have always been ordered like all others.
        let mut tied_first = bounded.filter(|index| !self.are_meshes(list, *index));
        self.broad_phase_by_gap(list, state, &mut best, measured);
        self.sort_candidates();
        for i in 0..self.candidates.len().min(UPPER_BOUNDS) {
            let index = self.candidates[i].index as usize;
            if Some(index) != bounded {
                self.tighten_upper_bound(list, index, state);
            }
        }
        for i in 0..self.candidates.len() {
            let Candidate { key, index, .. } = self.candidates[i];
            if self.exceeds_best(key, best.as_ref()) {
                self.narrow.stats.pairs_cleared.l2 += (self.candidates.len() - i) as u64;
                break;
            }
            let index = index as usize;
            let wins_ties = tied_first.take_if(|last| *last == index).is_some();
            self.measure(list, index, state, &mut best, wins_ties);
        }
        if let Some(index) = tied_first.filter(|last| self.may_tie(*last, best.as_ref())) {
            self.measure(list, index, state, &mut best, true);
        }
        self.answered();
        best
    }

    /// True if a pair that is at least this far apart cannot be the nearest.
    pub(super) fn exceeds_best(&self, metres: f64, best: Option<&PairDistance>) -> bool {
        metres > self.upper_bound || best.is_some_and(|b| metres >= b.metres)
    }

    /// True if a candidate may be as near as the nearest pair.
    fn may_tie(&self, index: usize, best: Option<&PairDistance>) -> bool {
        let candidate = self.candidates.iter().find(|candidate| candidate.index as usize == index);
        candidate.is_some_and(|c| c.key <= self.upper_bound && best.is_none_or(|b| c.key <= b.metres))
    }

    /// True for a pair of two meshes.
    fn are_meshes(&self, list: &PairList, index: usize) -> bool {
        let pair = &list.pairs[index];
        [pair.a, pair.b].iter().all(|model| self.scene.models[*model as usize].is_mesh())
    }

    /// Tightens the upper bound by the bound of one pair; false if computing that bound is not cheap.
    fn tighten_upper_bound(&mut self, list: &mut PairList, index: usize, state: &SceneState) -> bool {
        if !matches!(self.options.level, Level::Auto | Level::L3) {
            return false;
        }
        let pair = &mut list.pairs[index];
        let [a, b] = self.sides(pair, state);
        let Some(metres) = self.narrow.upper_bound(&a, &b, &mut pair.warm_start) else { return false };
        self.upper_bound = self.upper_bound.min((metres - pair.margin).max(0.0));
        true
    }

    /// Measures the distance of a robot's box to the box of another robot or an object.
    pub(super) fn measure_robot_boxes(
        &mut self,
        list: &PairList,
        block: &CarrierBlock,
        state: &SceneState,
        best: &mut Option<PairDistance>,
    ) {
        let (a, b) = (&state.boxes[block.a], &state.boxes[block.b]);
        let (on_a, on_b) = a.nearest_points(b);
        let gap = f64::from(a.gap(b));
        let mut pairs = list.pairs[block.start..block.end].iter();
        let Some(pair) = pairs.find(|p| self.proven_distance(p, state) < f64::INFINITY) else { return };
        let metres = (gap - block.margin).max(0.0);
        if best.is_none_or(|b| metres < b.metres) {
            let [x, y] = self.sides(pair, state).map(|p| p.model.id);
            // The block is ordered by box, the pair by geometry id.
            let box_of_x = state.carrier(x).map_or(pair.a as usize, |(r, _)| self.scene.models.len() + r.0);
            let (on_a, on_b) = if box_of_x == block.a { (on_a, on_b) } else { (on_b, on_a) };
            *best = Some(PairDistance { metres, lower_bound: metres, on_a, on_b, a: x, b: y, level: Level::L1 });
        }
    }

    /// Measures one pair, with the best distance so far as the limit. `wins_ties`: it is the nearest one also if it is as
    /// near as the best one.
    fn measure(
        &mut self,
        list: &mut PairList,
        index: usize,
        state: &SceneState,
        best: &mut Option<PairDistance>,
        wins_ties: bool,
    ) {
        let pair = &mut list.pairs[index];
        let sides = self.sides(pair, state);
        let level = self.options.pair_level();
        let margin = pair.margin + (sides[0].model.slack_m(level) + sides[1].model.slack_m(level));
        let limit = best.map_or(self.upper_bound, |b| b.metres.min(self.upper_bound)) + margin;
        let Some(found) = self.pair_distance(pair, &sides, state, margin, limit) else { return };
        let lower_bound = best.map_or(found.lower_bound, |b| b.lower_bound.min(found.lower_bound));
        if best.is_none_or(|b| found.metres < b.metres || wins_ties && found.metres <= b.metres) {
            list.nearest = Some(index);
            *best = Some(PairDistance { lower_bound, ..found });
        } else if let Some(best) = best {
            best.lower_bound = lower_bound;
        }
    }
}
