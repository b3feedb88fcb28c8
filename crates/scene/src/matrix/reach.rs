//! Pairs that no joint values bring together.

use super::PairMatrix;
use crate::Scene;

/// Marks what is proven out of reach.
pub(crate) fn prove(_scene: &Scene, matrix: PairMatrix) -> PairMatrix {
    matrix
}
