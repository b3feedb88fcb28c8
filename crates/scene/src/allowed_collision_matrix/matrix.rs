//! The matrix: one entry per pair, in a fixed order.

use std::collections::HashMap;

use elbowroom_robot::GeometryId;

use super::entry::{PairEntry, PairState};

/// One entry per pair: links of one robot, links of different robots, links and objects.
///
/// Complete (skipped pairs have an entry too, with a reason), reproducible (equal models give equal matrices) and in a fixed
/// order. Two objects are no pair while neither is attached to a robot.
///
/// What "skipped" means depends on the reason. Pairs that are out of reach are skipped only where the answer stays the
/// same: distance and tolerance queries use the proven least distance in their place, and they are tested in a state beyond
/// the joint limits, for which the proof does not hold.
#[derive(Debug, Clone)]
pub struct AllowedCollisionMatrix {
    entries: Vec<PairEntry>,
    index: HashMap<(GeometryId, GeometryId), usize>,
}

impl PartialEq for AllowedCollisionMatrix {
    fn eq(&self, other: &Self) -> bool {
        self.entries == other.entries
    }
}

impl AllowedCollisionMatrix {
    pub(crate) fn new(entries: Vec<PairEntry>) -> Self {
        let index = entries.iter().enumerate().map(|(i, e)| ((e.a, e.b), i)).collect();
        Self { entries, index }
    }

    /// All entries, in their order.
    pub fn entries(&self) -> &[PairEntry] {
        &self.entries
    }

    /// The entry of a pair, in either order of its geometries.
    pub fn get(&self, a: GeometryId, b: GeometryId) -> Option<&PairEntry> {
        self.position(a, b).map(|i| &self.entries[i])
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

    /// Skips each pair that samples suggest to skip. Answers may then differ from those of all pairs: samples are no proof.
    /// Returns the number of pairs changed.
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
