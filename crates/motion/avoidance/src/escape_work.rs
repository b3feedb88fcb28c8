//! Computing time of sweeps and of the search for escapes, counted in elementary tests.

use std::ops::Sub;

use elbowroom_scene::{CheckerStats, SweepOptions};

/// Measured costs, ns: upper estimates on the machine of `docs/measurements/avoidance.md` under other load.
const QUERY_NS: u64 = 8_000;
const EXACT_PAIR_NS: u64 = 6_000;
const COARSE_PAIR_NS: u64 = 200;
const CLEARED_PAIR_NS: u64 = 150;
const BOXES_NS: u64 = 1_000;
const TRIANGLES_NS: u64 = 1_000;
const SOLID_TRIANGLES_NS: u64 = 300;
const MARGIN_NS: u64 = 8_000;

/// An amount of work, ns. Equal on every machine, because it counts tests instead of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub(crate) struct EscapeWork(u64);

impl EscapeWork {
    pub(crate) const UNLIMITED: Self = Self(u64::MAX);

    pub(crate) const fn from_us(us: u32) -> Self {
        Self(us as u64 * 1000)
    }

    /// All work of a checker so far, plus a number of evaluations of a constraint.
    pub(crate) fn of(stats: &CheckerStats, margins: u64) -> Self {
        let exact = stats.pairs_tested.l3;
        let coarse = stats.pairs_tested.total() - exact;
        Self(
            QUERY_NS * stats.answered.total()
                + EXACT_PAIR_NS * exact
                + COARSE_PAIR_NS * coarse
                + CLEARED_PAIR_NS * stats.pairs_cleared.total()
                + BOXES_NS * stats.mesh_boxes
                + TRIANGLES_NS * stats.mesh_triangles
                + SOLID_TRIANGLES_NS * stats.triangles_beside_solids
                + MARGIN_NS * margins,
        )
    }

    /// Options of a sweep that ends when its exact tests alone have used up this work: what it has not proven by then
    /// counts as a hit. The boxes and triangles of the sweep are counted after its end, so that the next sweep is
    /// shorter.
    pub(crate) fn sweep_options(self, clearance_m: f64) -> SweepOptions {
        let options = SweepOptions { clearance_m, ..SweepOptions::default() };
        let exact_tests = u32::try_from(self.0 / EXACT_PAIR_NS).unwrap_or(u32::MAX);
        SweepOptions { max_steps: options.max_steps.min(exact_tests), ..options }
    }

    /// A fraction of the work.
    pub(crate) fn share(self, share: f64) -> Self {
        Self((self.0 as f64 * share) as u64)
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }

    pub(crate) fn us(self) -> u64 {
        self.0 / 1000
    }
}

impl Sub for EscapeWork {
    type Output = Self;

    /// The remaining work; 0 if the other amount is larger.
    fn sub(self, other: Self) -> Self {
        Self(self.0.saturating_sub(other.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_that_a_checker_counts_costs_something() {
        let free = EscapeWork::of(&CheckerStats::default(), 0);
        let counted: [fn(&mut CheckerStats); 7] = [
            |s| s.answered.l3 = 1,
            |s| s.pairs_tested.l3 = 1,
            |s| s.pairs_tested.hull = 1,
            |s| s.pairs_cleared.l1 = 1,
            |s| s.mesh_boxes = 1,
            |s| s.mesh_triangles = 1,
            |s| s.triangles_beside_solids = 1,
        ];
        for (i, count) in counted.iter().enumerate() {
            let mut stats = CheckerStats::default();
            count(&mut stats);
            assert!(EscapeWork::of(&stats, 0) > free, "{i}");
        }
        assert!(EscapeWork::of(&CheckerStats::default(), 1) > free);
    }
}
