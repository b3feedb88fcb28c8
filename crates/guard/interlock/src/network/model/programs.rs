//! Programs of the robots of a model.

use crate::{Occupancy, SlotId};

/// A closed sequence of places, with the robot's occupancy of each slot.
#[derive(Debug)]
pub(super) struct Program {
    slots: Vec<Vec<Occupancy>>,
}

impl Program {
    /// Builds a program from one word per slot: `_` is outside, `.` in the warning zone, `X` inside.
    pub(super) fn new(words: &[&str]) -> Self {
        let occupancy = |c: char| match c {
            'X' => Occupancy::Inside,
            '.' => Occupancy::Warning,
            _ => Occupancy::Outside,
        };
        Self { slots: words.iter().map(|word| word.chars().map(occupancy).collect()).collect() }
    }

    pub(super) fn slots(&self) -> usize {
        self.slots.len()
    }

    pub(super) fn uses(&self, slot: SlotId) -> bool {
        self.slots[slot.0].iter().any(|o| *o != Occupancy::Outside)
    }

    pub(super) fn next(&self, place: usize) -> usize {
        (place + 1) % self.slots[0].len()
    }

    pub(super) fn occupancy(&self, place: usize, slot: SlotId) -> Occupancy {
        self.slots[slot.0][place]
    }
}
