//! Path elements: straight segments and corner blends, parametrized by a path position `s`.

use super::corner_blend::derivatives;

/// A straight segment or a corner blend. The parameter of a straight segment is the length along it.
#[derive(Debug, Clone)]
pub(super) struct PathElement {
    /// Path position at the beginning.
    pub begin: f64,
    pub length: f64,
    pub from: Vec<f64>,
    /// Tangent at the beginning, a unit vector.
    pub direction: Vec<f64>,
    /// Change of the tangent over a corner blend; empty on a straight segment.
    pub turn: Vec<f64>,
}

impl PathElement {
    pub fn is_straight(&self) -> bool {
        self.turn.is_empty()
    }

    /// Position of one joint and its first three derivatives by `s`.
    pub fn at(&self, s: f64, joint: usize) -> [f64; 4] {
        let offset = (s - self.begin).clamp(0.0, self.length);
        let [q, p, c, d] = match self.turn.get(joint) {
            Some(&turn) => derivatives(self.direction[joint], turn, offset, self.length),
            None => [self.direction[joint] * offset, self.direction[joint], 0.0, 0.0],
        };
        [self.from[joint] + q, p, c, d]
    }
}
