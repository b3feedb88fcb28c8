//! Samples of the joint space for a search.

use super::tree_search::ConfigurationSampler;
use crate::rrt_connect::{Random, SamplingRegion};

/// Draws from the region around the ends first, later from all of it, and now and then near the ends again.
pub(super) struct RegionSampler<'r> {
    region: SamplingRegion,
    random: &'r mut Random,
    round: u32,
}

impl<'r> RegionSampler<'r> {
    pub fn new(region: SamplingRegion, random: &'r mut Random) -> Self {
        Self { region, random, round: 0 }
    }
}

/// One in so many samples stays near the ends.
const NEAR_ROUNDS: u32 = 4;
/// Share of the region about the ends that is sampled first, and in those rounds.
const NEAR_SHARE: f64 = 0.3;
/// Samples after which the whole region is sampled.
const WIDENING_ROUNDS: f64 = 40.0;

impl ConfigurationSampler for RegionSampler<'_> {
    fn sample(&mut self, out: &mut [f64]) {
        let is_near = self.round % NEAR_ROUNDS == NEAR_ROUNDS - 1;
        let wide = (NEAR_SHARE + f64::from(self.round) / WIDENING_ROUNDS).min(1.0);
        self.region.sample(if is_near { NEAR_SHARE } else { wide }, self.random, out);
        self.round = self.round.saturating_add(1);
    }
}
