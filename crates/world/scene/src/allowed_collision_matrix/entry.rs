//! One entry of the allowed collision matrix.

use std::fmt;

use elbowroom_robot::GeometryId;

use super::reason::Reason;

/// Whether a pair is tested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairState {
    /// Tested by collision queries.
    Tested,
    /// Skipped by collision queries.
    Skipped,
}

impl fmt::Display for PairState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tested => "tested",
            Self::Skipped => "skipped",
        })
    }
}

/// A number of an entry, for messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PairNumber {
    /// [`PairEntry::margin_m`].
    Margin,
    /// [`PairEntry::weight`].
    Weight,
}

impl fmt::Display for PairNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Margin => "margin_m",
            Self::Weight => "weight",
        })
    }
}

/// Entry of one pair.
#[derive(Debug, Clone, PartialEq)]
pub struct PairEntry {
    /// First geometry of the pair: lower robot index, then lower link index; links before objects.
    pub a: GeometryId,
    /// Second geometry of the pair.
    pub b: GeometryId,
    /// Whether the pair is tested.
    pub state: PairState,
    /// Security margin, metres: the pair collides if it is at most this far apart.
    ///
    /// The sum of the two paddings, unless set by hand.
    pub margin_m: f64,
    /// Weight, dimensionless. Pairs of larger weight are tested first.
    pub weight: f64,
    /// Why the pair is tested or skipped.
    pub reason: Reason,
    /// Reason that sampling suggests; without effect until [accepted](crate::AllowedCollisionMatrix::accept_suggestions).
    pub suggestion: Option<Reason>,
}
