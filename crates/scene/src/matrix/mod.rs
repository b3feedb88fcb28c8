//! Which pairs are tested, how far apart they must stay, in which order, and why.

mod law;
mod reach;
mod reason;
mod sample;
mod text;

use std::collections::HashMap;

use crate::{MatrixError, Member, Scene};

pub use reason::Reason;

pub(crate) use law::by_law;
pub(crate) use reach::prove;
pub(crate) use sample::RSequence;

/// Whether a pair counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairState {
    /// Looked at.
    Tested,
    /// Not looked at by collision queries.
    Skipped,
}

/// What is known of one pair.
#[derive(Debug, Clone, PartialEq)]
pub struct PairEntry {
    /// The member that comes first: lower robot, lower link, links before objects.
    pub a: Member,
    /// The other.
    pub b: Member,
    /// Whether it counts.
    pub state: PairState,
    /// They collide when they are not farther apart than this, metres: the padding of both, unless set by hand.
    pub margin_m: f64,
    /// Pairs of larger weight are looked at first. No unit.
    pub weight: f64,
    /// Why it is tested or skipped.
    pub reason: Reason,
    /// What samples suggest; changes nothing until [accepted](PairMatrix::accept_suggestions).
    pub suggestion: Option<Reason>,
}

/// A change to a pair.
#[derive(Debug, Clone, PartialEq)]
pub enum Edit {
    /// Skip it, with the reason why.
    Skip(String),
    /// Test it, with the reason why.
    Test(String),
    /// Metres that they must stay apart, in place of the paddings.
    Margin(f64),
    /// Its weight.
    Weight(f64),
}

/// Everything about every pair: links of one robot, links of different robots, links and objects.
///
/// Complete (there is an entry for each pair, skipped ones too, with a reason), reproducible (equal models give equal
/// matrices) and in a fixed order. Two objects are no pair while neither is attached to a robot.
///
/// What "skipped" means depends on the reason. Pairs that are out of reach are skipped only where the answer stays the
/// same: distance and tolerance questions use the proven least distance in their place, and a state beyond the joint
/// limits, for which nothing was proven, has them tested.
#[derive(Debug, Clone)]
pub struct PairMatrix {
    entries: Vec<PairEntry>,
    index: HashMap<(Member, Member), usize>,
}

impl PartialEq for PairMatrix {
    fn eq(&self, other: &Self) -> bool {
        self.entries == other.entries
    }
}

impl PairMatrix {
    pub(crate) fn new(entries: Vec<PairEntry>) -> Self {
        let index = entries.iter().enumerate().map(|(i, e)| ((e.a, e.b), i)).collect();
        Self { entries, index }
    }

    /// All entries, in their order.
    pub fn entries(&self) -> &[PairEntry] {
        &self.entries
    }

    /// The entry of a pair, named either way round.
    pub fn get(&self, a: Member, b: Member) -> Option<&PairEntry> {
        self.position(a, b).map(|i| &self.entries[i])
    }

    pub(crate) fn position(&self, a: Member, b: Member) -> Option<usize> {
        self.index.get(&(a.min(b), a.max(b))).copied()
    }

    pub(crate) fn entries_mut(&mut self) -> &mut [PairEntry] {
        &mut self.entries
    }

    /// Number of pairs that are tested.
    pub fn tested(&self) -> usize {
        self.entries.iter().filter(|e| e.state == PairState::Tested).count()
    }

    /// Changes one pair by hand; `scene` is for the names in errors.
    ///
    /// # Errors
    /// [`MatrixError`] where there is no such pair or the number cannot be.
    pub fn edit(&mut self, scene: &Scene, a: Member, b: Member, edit: Edit) -> Result<(), MatrixError> {
        self.edit_named(&|m| scene.name(m), a, b, edit)
    }

    pub(crate) fn edit_named(
        &mut self,
        name: &dyn Fn(Member) -> String,
        a: Member,
        b: Member,
        edit: Edit,
    ) -> Result<(), MatrixError> {
        let Some(at) = self.position(a, b) else {
            return Err(MatrixError::NoSuchPair { a: name(a), b: name(b) });
        };
        let entry = &mut self.entries[at];
        let check = |what, value: f64| {
            if value >= 0.0 && value.is_finite() {
                return Ok(value);
            }
            Err(MatrixError::Number { a: name(a), b: name(b), what, value })
        };
        match edit {
            Edit::Skip(note) => (entry.state, entry.reason) = (PairState::Skipped, Reason::ByHand(note)),
            Edit::Test(note) => (entry.state, entry.reason) = (PairState::Tested, Reason::ByHand(note)),
            Edit::Weight(weight) => entry.weight = check("weight", weight)?,
            Edit::Margin(margin_m) => {
                entry.margin_m = check("margin_m", margin_m)?;
                // Out of reach of each other, but not out of reach of the margin.
                if matches!(entry.reason, Reason::OutOfReach { least_m } if least_m <= entry.margin_m) {
                    (entry.state, entry.reason) = (PairState::Tested, Reason::Default);
                }
            }
        }
        Ok(())
    }

    /// Skips each pair that samples suggest to skip. From then on answers may differ from those of all pairs: a sample
    /// is no proof. Returns how many.
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
