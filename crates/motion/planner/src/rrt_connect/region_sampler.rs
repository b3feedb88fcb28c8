//! Samples of the joint space for a search.

use super::joint_bounds::SamplingRegion;
use super::random::Random;
use super::tree_search::ConfigurationSampler;

/// Draws samples around the root of the growing tree and from the region: first around the ends, later everywhere.
pub(crate) struct RegionSampler<'r> {
    region: SamplingRegion,
    random: &'r mut Random,
    round: u32,
}

impl<'r> RegionSampler<'r> {
    pub fn new(region: SamplingRegion, random: &'r mut Random) -> Self {
        Self { region, random, round: 0 }
    }
}

/// Fraction of the samples that are drawn around the root: most failing searches cannot leave a narrow place around an
/// end.
const LOCAL_SHARE: f64 = 0.6;
/// Largest distance of these samples from the root, in each value, rad (and m).
const LOCAL_DISTANCE: f64 = 2.0;
/// Fraction of the region, around the ends, that is sampled first.
const NEAR_SHARE: f64 = 0.3;
/// Approximate number of samples after which the whole region is sampled.
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
