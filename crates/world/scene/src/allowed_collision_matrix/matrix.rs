//! The allowed collision matrix: one entry per pair, in a fixed order.

use std::collections::{BTreeMap, HashMap};

use elbowroom_robot::GeometryId;

use super::entry::{PairEntry, PairState};
use super::reason::Reason;

/// Weight of a pair of objects, one of which is attached: equal to that of two large bodies that one joint moves.
///
/// Dimensionless.
pub(crate) const OBJECTS_WEIGHT: f64 = 1.0;

/// Allowed collision matrix: one entry per pair of links, and per pair of a link and an object.
///
/// The matrix is complete (skipped pairs have an entry too, with a reason), reproducible (equal models give equal
/// matrices) and in a fixed order. Two objects form a pair only while one of them is attached to a robot. They have an
/// entry only if the pair was [edited](AllowedCollisionMatrix::edit); the edit applies while one of them is attached.
///
/// What "skipped" means depends on the reason. Pairs that are out of reach are skipped only if the answer stays the same:
/// distance and tolerance queries use the proven least distance instead of a measurement. In a state beyond the joint
/// limits, where the proof does not hold, these pairs are tested.
#[derive(Debug, Clone)]
pub struct AllowedCollisionMatrix {
    entries: Vec<PairEntry>,
    index: HashMap<(GeometryId, GeometryId), usize>,
    /// Edited pairs of two objects.
    of_objects: BTreeMap<(GeometryId, GeometryId), PairEntry>,
}

impl PartialEq for AllowedCollisionMatrix {
    fn eq(&self, other: &Self) -> bool {
        self.entries == other.entries && self.of_objects == other.of_objects
    }
}

impl AllowedCollisionMatrix {
    pub(crate) fn new(entries: Vec<PairEntry>) -> Self {
        let index = entries.iter().enumerate().map(|(i, e)| ((e.a, e.b), i)).collect();
        Self { entries, index, of_objects: BTreeMap::new() }
    }

    /// All entries in order, without the pairs of two objects.
    pub fn entries(&self) -> &[PairEntry] {
        &self.entries
    }

    /// The edited pairs of two objects, in the order of the objects.
    pub fn object_entries(&self) -> impl Iterator<Item = &PairEntry> {
        self.of_objects.values()
    }

    /// The entry of a pair, with its geometries in either order.
    pub fn get(&self, a: GeometryId, b: GeometryId) -> Option<&PairEntry> {
        let of_objects = || self.of_objects.get(&(a.min(b), a.max(b)));
        self.position(a, b).map(|i| &self.entries[i]).or_else(of_objects)
    }

    /// The entry to edit. For two objects without an entry, makes one with their margin (m).
    pub(super) fn entry_mut(&mut self, a: GeometryId, b: GeometryId, margin_m: f64) -> Option<&mut PairEntry> {
        if let Some(at) = self.position(a, b) {
            return Some(&mut self.entries[at]);
        }
        let (a, b) = (a.min(b), a.max(b));
        let objects = matches!((a, b), (GeometryId::Object(_), GeometryId::Object(_)));
        let (state, reason) = (PairState::Tested, Reason::Default);
        let entry = PairEntry { a, b, state, margin_m, weight: OBJECTS_WEIGHT, reason, suggestion: None };
        (objects && a != b).then(|| self.of_objects.entry((a, b)).or_insert(entry))
    }

    pub(crate) fn position(&self, a: GeometryId, b: GeometryId) -> Option<usize> {
        self.index.get(&(a.min(b), a.max(b))).copied()
    }

    pub(crate) fn entries_mut(&mut self) -> &mut [PairEntry] {
        &mut self.entries
    }

    /// Number of pairs that are tested.
    pub fn tested(&self) -> usize {
        self.entries.iter().filter(|e| e.state == PairState::Tested).count()
    }

    /// Skips each tested pair that has a suggestion, and returns the number of pairs changed.
    ///
    /// Answers may then differ from the answers for all pairs, because samples prove nothing.
    pub fn accept_suggestions(&mut self) -> usize {
        let mut accepted = 0;
        for entry in &mut self.entries {
            if let (PairState::Tested, Some(reason)) = (entry.state, entry.suggestion.take()) {
                (entry.state, entry.reason) = (PairState::Skipped, reason);
                accepted += 1;
            }
        }
        accepted
    }
}
