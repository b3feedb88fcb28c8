//! Samples of the joint space for a search.

use super::tree_search::ConfigurationSampler;
use crate::rrt_connect::{Random, SamplingRegion};

/// Draws around the root of the tree that grows, and from the region: that around the ends first, later all of it.
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

/// Share of the samples that are drawn around the root: most searches fail to leave a narrow place around an end.
const LOCAL_SHARE: f64 = 0.6;
/// How far from the root they are at most, in each value, rad (and m).
const LOCAL_DISTANCE: f64 = 2.0;
/// Share of the region about the ends that is sampled first.
const NEAR_SHARE: f64 = 0.3;
/// Samples after which the whole region is sampled.
const WIDENING_ROUNDS: f64 = 40.0;

impl ConfigurationSampler for RegionSampler<'_> {
    fn sample(&mut self, root: &[f64], out: &mut [f64]) {
        if self.random.unit() < LOCAL_SHARE {
            self.region.clamped_around(root, LOCAL_DISTANCE, self.random, out);
            return;
        }
        let share = (NEAR_SHARE + f64::from(self.round) / WIDENING_ROUNDS).min(1.0);
        self.region.sample(share, self.random, out);
        self.round = self.round.saturating_add(1);
    }
}
