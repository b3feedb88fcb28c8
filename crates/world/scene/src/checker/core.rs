//! State that all queries of a checker share.

use elbowroom_spatial::FrameMotion;

use super::options::CheckerOptions;
use super::pair_list::GeometryPair;
use crate::narrow_phase::{NarrowPhase, PlacedModel};
use crate::{Level, Scene, SceneState};

/// Scene, settings and workspace of a checker, without the pair lists.
#[derive(Debug, Clone)]
pub(crate) struct CheckerCore<'s> {
    pub scene: &'s Scene,
    pub options: CheckerOptions,
    pub narrow: NarrowPhase,
    /// Pairs that the broad phase left undecided.
    pub candidates: Vec<Candidate>,
    /// Per model: its motion, and a bound on the speed (m/s) of its points. Workspace of the query for approaching pairs.
    pub moving: Vec<(FrameMotion, f64)>,
    /// Upper bound on the minimum distance, metres.
    pub upper_bound: f64,
    /// The finest level that the present query has used.
    pub finest: Level,
}

/// A pair that the broad phase left undecided.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Candidate {
    /// Sort key, small first.
    ///
    /// Minimum distance: a lower bound on the distance less margin, m. Collision and tolerance queries with
    /// [`CheckerOptions::weights`]: the negative weight of the pair. All other queries: 0, so that the rank decides.
    pub key: f64,
    /// Position of the pair in the order of the hierarchy, which decides among equal keys: [`GeometryPair::rank`].
    pub rank: u32,
    /// Index of the pair in the list of the query.
    pub index: u32,
}

impl<'s> CheckerCore<'s> {
    pub fn new(scene: &'s Scene, options: CheckerOptions) -> Self {
        Self {
            scene,
            options,
            narrow: NarrowPhase::new(scene),
            candidates: Vec::new(),
            moving: Vec::with_capacity(scene.models.len()),
            upper_bound: f64::INFINITY,
            finest: Level::L1,
        }
    }

    pub fn sides(&self, pair: &GeometryPair, state: &SceneState) -> [PlacedModel<'s>; 2] {
        [pair.a, pair.b].map(|model| PlacedModel::new(self.scene, state, model as usize))
    }

    /// Records that the query has used a level.
    pub fn used(&mut self, level: Level) {
        self.finest = self.finest.max(level);
    }

    /// Records that the models of a level prove a pair clear.
    pub fn cleared(&mut self, level: Level) {
        self.narrow.stats.pairs_cleared.add(level, 1);
        self.used(level);
    }

    /// Records the end of a query.
    pub fn answered(&mut self) {
        self.narrow.stats.answered.add(self.finest, 1);
    }

    /// Least distance (m) of a pair that the allowed collision matrix proves for a state; 0 without a proof.
    pub fn proven_distance(&self, pair: &GeometryPair, state: &SceneState) -> f64 {
        let side = |model: u32| state.proofs_hold(self.scene.models[model as usize].id);
        let holds = pair.proven_least_m > 0.0
            && self.options.matrix
            && (state.all_proofs_hold || (side(pair.a) && side(pair.b)));
        if holds { pair.proven_least_m } else { 0.0 }
    }

    /// True if, at [`Level::Auto`], coarse models prove a pair farther apart than `limit` metres.
    pub fn cleared_coarsely(&mut self, [a, b]: &[PlacedModel<'s>; 2], limit: f64) -> bool {
        if self.options.level == Level::Auto
            && self.options.uses_boxes()
            && limit < f64::INFINITY
            && let Some(level) = self.narrow.separated_coarsely(a, b, limit)
        {
            self.cleared(level);
            return true;
        }
        false
    }
}
