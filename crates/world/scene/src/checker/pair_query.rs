//! Queries about a selection of pairs.

use elbowroom_proximity::contact::Detail;
use elbowroom_robot::RobotId;

use super::core::CheckerCore;
use super::pair_list::PairList;
use super::result::{ApproachingPair, CollisionPoint, PairContact, PairDistance};
use crate::sweep::{SweepHit, SweepMove, SweepOptions, Sweeper};
use crate::{LevelOfDetail, SceneError, SceneMotion, SceneState};

/// Queries about a selection of pairs. Created by [`Checker::between`](crate::Checker::between).
#[derive(Debug)]
pub struct PairQuery<'c, 's> {
    pub(super) core: &'c mut CheckerCore<'s>,
    pub(super) list: &'c mut PairList,
    /// Created at the first sweep.
    pub(super) sweeper: &'c mut Option<Box<Sweeper>>,
}

impl<'s> PairQuery<'_, 's> {
    /// The core and the list, after an update of the list to the attachments of the state.
    fn updated(&mut self, state: &SceneState) -> (&mut CheckerCore<'s>, &mut PairList) {
        self.update(state);
        (&mut *self.core, &mut *self.list)
    }

    /// Updates the list to the attachments of the state.
    pub(super) fn update(&mut self, state: &SceneState) {
        if self.list.arrangement != Some(state.arrangement) {
            self.list.rebuild(self.core.scene, state);
            self.core.candidates.clear();
            self.core.candidates.reserve(self.list.pairs.len());
        }
    }

    /// Number of pairs, including pairs out of reach.
    pub fn len(&mut self, state: &SceneState) -> usize {
        self.updated(state).1.pairs.len()
    }

    /// True if the selection has no pair.
    pub fn is_empty(&mut self, state: &SceneState) -> bool {
        self.len(state) == 0
    }

    /// Like [`Checker::collides`](crate::Checker::collides).
    pub fn collides(&mut self, state: &SceneState) -> Option<PairContact> {
        self.within(state, 0.0)
    }

    /// Like [`Checker::contacts`](crate::Checker::contacts).
    pub fn contacts(&mut self, state: &SceneState, found: impl FnMut(PairContact)) {
        let (core, list) = self.updated(state);
        core.all_contacts(list, state, found);
    }

    /// Like [`Checker::within`](crate::Checker::within).
    pub fn within(&mut self, state: &SceneState, tolerance_m: f64) -> Option<PairContact> {
        let (core, list) = self.updated(state);
        core.first_contact(list, state, tolerance(tolerance_m))
    }

    /// Like [`Checker::collision_point`](crate::Checker::collision_point).
    pub fn collision_point(&mut self, state: &SceneState, detail: Detail) -> Option<CollisionPoint> {
        let (core, list) = self.updated(state);
        core.collision_point(list, state, detail)
    }

    /// Like [`Checker::distance`](crate::Checker::distance).
    pub fn distance(&mut self, state: &SceneState) -> Option<PairDistance> {
        let (core, list) = self.updated(state);
        core.minimum_distance(list, state)
    }

    /// Like [`Checker::distances_within`](crate::Checker::distances_within).
    pub fn distances_within(&mut self, state: &SceneState, margin_m: f64, found: impl FnMut(PairDistance)) {
        let (core, list) = self.updated(state);
        core.distances_within(list, state, tolerance(margin_m), found);
    }

    /// Like [`Checker::approaching`](crate::Checker::approaching).
    pub fn approaching(
        &mut self,
        state: &SceneState,
        motion: &SceneMotion,
        policy: &LevelOfDetail,
        horizon_s: f64,
        found: impl FnMut(ApproachingPair),
    ) {
        let (core, list) = self.updated(state);
        core.approaching(list, state, motion, policy, horizon_s, found);
    }

    /// Like [`Checker::sweep`](crate::Checker::sweep).
    ///
    /// # Errors
    /// The errors of [`Checker::sweep`](crate::Checker::sweep).
    pub fn sweep(
        &mut self,
        start: &SceneState,
        moves: &[SweepMove],
        options: &SweepOptions,
    ) -> Result<Option<SweepHit>, SceneError> {
        self.update(start);
        sweeper(self.sweeper, self.core).sweep(self.core, self.list, start, moves, options)
    }

    /// Like [`Checker::sweep_path`](crate::Checker::sweep_path).
    ///
    /// # Errors
    /// The errors of [`Checker::sweep_path`](crate::Checker::sweep_path).
    pub fn sweep_path<Q: AsRef<[f64]>>(
        &mut self,
        start: &SceneState,
        robot: RobotId,
        waypoints: &[Q],
        options: &SweepOptions,
    ) -> Result<Option<(usize, SweepHit)>, SceneError> {
        self.update(start);
        sweeper(self.sweeper, self.core).sweep_path(self.core, self.list, start, robot, waypoints, options)
    }
}

fn sweeper<'c>(sweeper: &'c mut Option<Box<Sweeper>>, core: &CheckerCore) -> &'c mut Sweeper {
    sweeper.get_or_insert_with(|| Box::new(Sweeper::new(core.scene, core.options.pair_level())))
}

/// A tolerance in metres; NaN is infinite.
fn tolerance(metres: f64) -> f64 {
    if metres.is_nan() { f64::INFINITY } else { metres.max(0.0) }
}
