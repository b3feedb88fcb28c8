//! Questions about some pairs of a scene.

use elbowroom_proximity::contact::Detail;

use super::answer::{CollisionPoint, Contact, Distance};
use super::{Checker, Core, PairList};
use crate::sweep::Sweeper;
use crate::{Approach, Impact, LevelOfDetail, Move, SceneError, SceneMotion, SceneState, SweepOptions};

/// Questions about some pairs of the scene; see [`Checker::between`].
#[derive(Debug)]
pub struct Between<'c, 's> {
    pub(super) checker: &'c mut Checker<'s>,
    pub(super) list: usize,
}

impl<'s> Between<'_, 's> {
    /// Core and an up-to-date list.
    pub(super) fn fresh(&mut self, state: &SceneState) -> (&mut Core<'s>, &mut PairList) {
        let Checker { core, lists, .. } = &mut *self.checker;
        let list = &mut lists[self.list];
        if list.arrangement != Some(state.arrangement) {
            list.arrange(core.scene, state);
            core.candidates.clear();
            core.candidates.reserve(list.pairs.len());
        }
        (core, list)
    }

    /// Number of pairs, those out of reach included.
    pub fn len(&mut self, state: &SceneState) -> usize {
        self.fresh(state).1.pairs.len()
    }

    /// True where there is no pair.
    pub fn is_empty(&mut self, state: &SceneState) -> bool {
        self.len(state) == 0
    }

    /// As [`Checker::collides`].
    pub fn collides(&mut self, state: &SceneState) -> Option<Contact> {
        self.within(state, 0.0)
    }

    /// As [`Checker::contacts`].
    pub fn contacts(&mut self, state: &SceneState, found: impl FnMut(Contact)) {
        let (core, list) = self.fresh(state);
        core.all(list, state, found);
    }

    /// As [`Checker::within`].
    pub fn within(&mut self, state: &SceneState, tolerance_m: f64) -> Option<Contact> {
        let (core, list) = self.fresh(state);
        core.first(list, state, tolerance(tolerance_m))
    }

    /// As [`Checker::collision`].
    pub fn collision(&mut self, state: &SceneState, detail: Detail) -> Option<CollisionPoint> {
        let (core, list) = self.fresh(state);
        core.collision(list, state, detail)
    }

    /// As [`Checker::near`].
    pub fn near(&mut self, state: &SceneState, margin_m: f64, found: impl FnMut(Distance)) {
        let (core, list) = self.fresh(state);
        core.near(list, state, tolerance(margin_m), found);
    }

    /// As [`Checker::approaching`].
    pub fn approaching(
        &mut self,
        state: &SceneState,
        motion: &SceneMotion,
        policy: &LevelOfDetail,
        horizon_s: f64,
        found: impl FnMut(Approach),
    ) {
        let (core, list) = self.fresh(state);
        core.approaching(list, (state, motion), policy, horizon_s, found);
    }

    /// As [`Checker::sweep`].
    ///
    /// # Errors
    /// As there.
    pub fn sweep(
        &mut self,
        start: &SceneState,
        moves: &[Move],
        options: &SweepOptions,
    ) -> Result<Option<Impact>, SceneError> {
        let (core, list, sweeper) = self.sweeping(start);
        sweeper.sweep(core, list, start, moves, options)
    }

    /// As [`Checker::sweep_path`].
    ///
    /// # Errors
    /// As there.
    pub fn sweep_path<Q: AsRef<[f64]>>(
        &mut self,
        start: &SceneState,
        robot: usize,
        waypoints: &[Q],
        options: &SweepOptions,
    ) -> Result<Option<(usize, Impact)>, SceneError> {
        let (core, list, sweeper) = self.sweeping(start);
        sweeper.sweep_path(core, list, start, robot, waypoints, options)
    }

    fn sweeping(&mut self, start: &SceneState) -> (&mut Core<'s>, &mut PairList, &mut Sweeper) {
        self.fresh(start);
        let Checker { core, lists, sweeper } = &mut *self.checker;
        let sweeper = sweeper.get_or_insert_with(|| Box::new(Sweeper::new(core.scene, core.fine())));
        (core, &mut lists[self.list], sweeper)
    }

    /// As [`Checker::distance`].
    pub fn distance(&mut self, state: &SceneState) -> Option<Distance> {
        let (core, list) = self.fresh(state);
        core.nearest(list, state)
    }
}

/// What is no number of metres is all of them.
fn tolerance(metres: f64) -> f64 {
    if metres.is_nan() { f64::INFINITY } else { metres.max(0.0) }
}
