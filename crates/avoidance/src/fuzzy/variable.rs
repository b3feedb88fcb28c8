//! A number in words.

use super::Set;

/// A quantity and the words for its size.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Its name in rules.
    pub name: String,
    /// Inputs are taken into this range, outputs too. Sets may reach beyond it: an output's first set usually does,
    /// so that its centre of gravity can be the end of the range.
    pub range: [f64; 2],
    /// The words, from small to large.
    pub sets: Vec<(String, Set)>,
}

impl Variable {
    /// Number of the set of that name.
    pub fn set(&self, name: &str) -> Option<usize> {
        self.sets.iter().position(|(n, _)| n == name)
    }

    /// The number within the range; NaN becomes `instead`.
    pub(super) fn within(&self, x: f64, instead: f64) -> f64 {
        if x.is_nan() { instead } else { x.clamp(self.range[0], self.range[1]) }
    }

    /// From the lowest to the highest number that any set or the range speaks of.
    pub(super) fn extent(&self) -> [f64; 2] {
        let corners = self.sets.iter().map(|(_, s)| s.corners());
        corners.fold(self.range, |[low, high], c| [low.min(c[0]), high.max(c[3])])
    }
}
