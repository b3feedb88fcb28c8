//! The collision point: where, on which link, which way its surface looks.

use elbowroom_proximity::contact::Detail;

use super::answer::CollisionPoint;
use super::list::PairList;
use super::narrow::Placed;
use super::{Candidate, Core};
use crate::{Level, Member, SceneState, weight};

impl<'s> Core<'s> {
    /// The contact of the pair that is first in the order of the hierarchy.
    pub(super) fn collision(&mut self, list: &PairList, state: &SceneState, detail: Detail) -> Option<CollisionPoint> {
        self.collect(list, state, 0.0, false);
        self.sort();
        let mut found = None;
        for i in 0..self.candidates.len() {
            let Candidate { index, .. } = self.candidates[i];
            let pair = &list.pairs[index as usize];
            let sides = self.sides(pair, state);
            if self.options.level == Level::Auto
                && self.boxes_decide()
                && let Some(level) = self.narrow.cleared_coarsely(&sides[0], &sides[1], pair.margin)
            {
                self.narrow.counts.pairs_cleared.add(level, 1);
                self.deepen(level);
                continue;
            }
            self.deepen(Level::L3);
            found = self.meet(&sides, pair.margin, detail);
            if found.is_some() {
                break;
            }
            self.narrow.counts.pairs_cleared.add(Level::L3, 1);
        }
        self.narrow.counts.answered.add(self.deepest, 1);
        found.map(|c| self.link_first(c, state))
    }

    fn meet(&mut self, [a, b]: &[Placed<'s>; 2], margin: f64, detail: Detail) -> Option<CollisionPoint> {
        let (bodies, found) = self.narrow.meet(a, b, detail, margin)?;
        Some(CollisionPoint::new((a.model.member, b.model.member), bodies, &found, detail))
    }

    /// The side nearer to its base comes first; what hangs on no robot comes last.
    fn link_first(&self, c: CollisionPoint, state: &SceneState) -> CollisionPoint {
        let depth = |m: Member| {
            let carrier = state.carrier(m);
            carrier.map_or(usize::MAX, |(robot, link)| weight::depth(&self.scene.robots, Member::Link { robot, link }))
        };
        if depth(c.other) < depth(c.link) { c.swapped() } else { c }
    }
}
