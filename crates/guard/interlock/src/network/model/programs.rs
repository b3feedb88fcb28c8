//! Programs of the robots of a model.

use crate::{Occupancy, SlotId};

/// Where a robot is, seen from a slot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    Outside,
    Warning,
    /// At rest so near that it may count as one that can no longer stop outside. It does not enter without a grant.
    RestsCommitted,
    Inside,
}

/// A sequence of places, seen from each slot.
#[derive(Debug)]
pub(super) struct Program {
    slots: Vec<Vec<Place>>,
    /// True if each place may follow each other one; otherwise the next one follows, and the first one the last.
    is_free: bool,
}

impl Program {
    /// Builds a program from one word per slot: `_` is outside, `.` in the warning zone, `c` at rest before the border, `X`
    /// inside.
    pub(super) fn new(words: &[&str]) -> Self {
        let place = |c: char| match c {
            'X' => Place::Inside,
            'c' => Place::RestsCommitted,
            '.' => Place::Warning,
            _ => Place::Outside,
        };
        Self { slots: words.iter().map(|word| word.chars().map(place).collect()).collect(), is_free: false }
    }

    /// The same places in any order.
    pub(super) fn in_any_order(self) -> Self {
        Self { is_free: true, ..self }
    }

    pub(super) fn slots(&self) -> usize {
        self.slots.len()
    }

    pub(super) fn uses(&self, slot: SlotId) -> bool {
        self.slots[slot.0].iter().any(|place| *place != Place::Outside)
    }

    /// The places that may follow.
    pub(super) fn nexts(&self, place: usize) -> impl Iterator<Item = usize> + use<> {
        let (places, is_free) = (self.slots[0].len(), self.is_free);
        (0..places).filter(move |next| if is_free { *next != place } else { *next == (place + 1) % places })
    }

    pub(super) fn occupancy(&self, place: usize, slot: SlotId) -> Occupancy {
        match self.slots[slot.0][place] {
            Place::Outside => Occupancy::Outside,
            Place::Warning => Occupancy::Warning,
            Place::RestsCommitted => Occupancy::Committed,
            Place::Inside => Occupancy::Inside,
        }
    }

    /// Whether the robot is inside, where it needs a grant to get to.
    pub(super) fn is_inside(&self, place: usize, slot: SlotId) -> bool {
        self.slots[slot.0][place] == Place::Inside
    }
}
