//! The distance of one pair, for minimum-distance and tolerance queries.

use super::core::CheckerCore;
use super::pair_list::GeometryPair;
use super::result::{PairDistance, less_margin};
use crate::SceneState;
use crate::narrow_phase::PlacedModel;

impl<'s> CheckerCore<'s> {
    /// Measures one pair, from coarse to fine; `None` if the models are proven farther apart than `limit` metres.
    ///
    /// `margin` is the pair's margin plus the length by which the models may fail to enclose the geometry.
    pub(super) fn pair_distance(
        &mut self,
        pair: &mut GeometryPair,
        sides: &[PlacedModel<'s>; 2],
        state: &SceneState,
        margin: f64,
        limit: f64,
    ) -> Option<PairDistance> {
        if self.cleared_coarsely(sides, limit) {
            return None;
        }
        let level = self.options.pair_level();
        self.used(level);
        let [a, b] = sides;
        let Some(s) = self.narrow.separation(a, b, level, limit, &mut pair.warm_start) else {
            self.narrow.stats.pairs_cleared.add(level, 1);
            return None;
        };
        // A proof about the exact shapes may be tighter than the bound of enclosing volumes.
        let proven = (self.proven_distance(pair, state) - pair.margin).max(0.0);
        let (metres, lower_bound) = less_margin(&s, margin);
        let (metres, lower_bound) = (metres.max(proven), lower_bound.max(proven));
        Some(PairDistance { metres, lower_bound, on_a: s.on_a, on_b: s.on_b, a: a.model.id, b: b.model.id, level })
    }
}
