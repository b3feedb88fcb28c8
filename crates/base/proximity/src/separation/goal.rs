//! The goal of a query over a pair of shapes.

use super::settings::WitnessPoints;

/// The goal of a query over a pair of shapes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Goal {
    /// A separation with these witness points.
    Separation(WitnessPoints),
    /// Whether the shapes are within the limit: only `Some` or `None` matters.
    WithinLimit,
}

impl Goal {
    /// The distance and continuous witness points.
    pub const CONTINUOUS: Self = Self::Separation(WitnessPoints::Continuous);

    #[inline]
    pub fn is_continuous(self) -> bool {
        self == Self::CONTINUOUS
    }
}
