//! Fuzzy variables.

use super::Set;

/// A fuzzy variable: a quantity and the sets that describe it.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name in rules.
    pub name: String,
    /// Range to which inputs and outputs are clamped. Sets may extend beyond it: the outer sets of an output usually
    /// do, so that the centre of gravity can reach the ends of the range.
    pub range: [f64; 2],
    /// Name and set, in ascending order.
    pub sets: Vec<(String, Set)>,
}

impl Variable {
    /// Index of the set with this name.
    pub fn set(&self, name: &str) -> Option<usize> {
        self.sets.iter().position(|(n, _)| n == name)
    }

    /// `x` clamped to the range; NaN becomes `default`.
    pub(super) fn within(&self, x: f64, default: f64) -> f64 {
        if x.is_nan() { default } else { x.clamp(self.range[0], self.range[1]) }
    }

    /// The range extended by all sets.
    pub(super) fn extent(&self) -> [f64; 2] {
        let corners = self.sets.iter().map(|(_, s)| s.corners());
        corners.fold(self.range, |[low, high], c| [low.min(c[0]), high.max(c[3])])
    }
}
