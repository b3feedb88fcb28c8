//! The collision point: position, link, collider and surface normal.

use elbowroom_proximity::contact::{ContactSettings, Detail};
use elbowroom_robot::GeometryId;

use super::core::CheckerCore;
use super::pair_list::PairList;
use super::result::{ColliderId, CollisionPoint};
use crate::{Level, SceneState, pair_weight};

impl CheckerCore<'_> {
    /// Finds the contact of the pair that is first in the order of the hierarchy.
    pub(super) fn collision_point(
        &mut self,
        list: &PairList,
        state: &SceneState,
        detail: Detail,
    ) -> Option<CollisionPoint> {
        self.broad_phase(list, state, 0.0, false);
        self.sort_candidates();
        let mut found = None;
        for i in 0..self.candidates.len() {
            let pair = &list.pairs[self.candidates[i].index as usize];
            let sides = self.sides(pair, state);
            if self.cleared_coarsely(&sides, pair.margin) {
                continue;
            }
            self.used(Level::L3);
            let [a, b] = sides;
            let contact = self.narrow.contact_point(&a, &b, ContactSettings { limit: pair.margin, detail });
            found = contact.map(|((of_a, of_b), c)| {
                let a = ColliderId { geometry: a.model.id, collider: of_a };
                let b = ColliderId { geometry: b.model.id, collider: of_b };
                CollisionPoint::new(a, b, &c, detail)
            });
            if found.is_some() {
                break;
            }
            self.narrow.stats.pairs_cleared.add(Level::L3, 1);
        }
        self.answered();
        found.map(|c| self.link_first(c, state))
    }

    /// Puts the side nearer to its base first, and an unattached object last.
    fn link_first(&self, c: CollisionPoint, state: &SceneState) -> CollisionPoint {
        let depth = |id: GeometryId| {
            let carrier = state.carrier(id);
            carrier.map_or(usize::MAX, |(robot, link)| pair_weight::link_depth(&self.scene.robots, robot, link))
        };
        if depth(c.other) < depth(c.link) { c.swapped() } else { c }
    }
}
