//! The choice among tied pairs of witness points.

use elbowroom_spatial::Vec3;

use super::patch_query::PatchQuery;
use super::tolerances::PatchTolerances;

/// The choice of the pair nearest to the anchor, among the offered tied pairs of points.
#[derive(Debug)]
pub(crate) struct WitnessChoice<Key> {
    pub query: PatchQuery,
    min_size: f64,
    /// The witness point found first, on the first shape.
    first: Vec3,
    /// True after tied points were found that are farther apart than the smallest patch: the witness points are not
    /// unique.
    ambiguous: bool,
    /// Distances from the anchor that differ by less count as equal, and the smaller key decides, so that the result
    /// does not depend on the order of the offers.
    step: f64,
    best: Option<Chosen<Key>>,
}

#[derive(Debug, Clone, Copy)]
struct Chosen<Key> {
    /// Distance from the anchor in whole steps.
    score: f64,
    key: Key,
    on_a: Vec3,
    on_b: Vec3,
}

impl<Key: Copy + PartialOrd> WitnessChoice<Key> {
    pub fn new(query: PatchQuery, tolerances: PatchTolerances, first: Vec3) -> Self {
        let min_size = tolerances.min_size;
        Self { query, min_size, first, ambiguous: false, step: 1e-3 * min_size, best: None }
    }

    /// True if a feature cannot change the choice. `nearest` returns the feature's point nearest to the anchor.
    pub fn is_beaten(&self, nearest: impl FnOnce(Vec3) -> Vec3) -> bool {
        let Some(best) = self.best.filter(|_| self.ambiguous) else { return false };
        nearest(self.query.anchor).distance(self.query.anchor) > (best.score + 1.0) * self.step
    }

    /// Records a tied point of the first shape.
    pub fn note_point(&mut self, on_a: Vec3) {
        self.ambiguous |= on_a.distance(self.first) > self.min_size;
    }

    /// Records the size of a patch of tied points.
    pub fn note_patch(&mut self, size: f64) {
        self.ambiguous |= size > self.min_size;
    }

    pub fn offer(&mut self, key: Key, on_a: Vec3, on_b: Vec3) {
        let score = (on_a.distance(self.query.anchor) / self.step).round();
        if self.best.is_none_or(|b| (score, key) < (b.score, b.key)) {
            self.best = Some(Chosen { score, key, on_a, on_b });
        }
    }

    /// Key and points of the choice; `None` if the witness points are unique.
    pub fn chosen(&self) -> Option<(Key, Vec3, Vec3)> {
        self.best.filter(|_| self.ambiguous).map(|b| (b.key, b.on_a, b.on_b))
    }
}
