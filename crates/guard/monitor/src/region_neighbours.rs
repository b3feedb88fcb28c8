//! The regions that a guarded volume may come near soon, and what earlier ticks say about their distances.
//!
//! A volume moves by a millimetre in a tick, so nearly all distances are known well enough from earlier ticks: no
//! distance changes by more than the volumes travel. This is the neighbour list of molecular dynamics (Verlet 1967, the
//! "skin" around each cut-off radius) with a bound of the distance kept for each neighbour.

use elbowroom_proximity::Separation;

use crate::Configuration;
use crate::broad_phase::RegionTree;
use crate::placement::Placement;

/// Distance (m) beyond the reach of the laws within which regions are listed. With more, the list is longer; with less, it
/// is made more often.
const SKIN_M: f64 = 0.1;
/// Allowance for rounding errors of distances and travels, m.
const ROUNDING_M: f64 = 1e-9;

/// Bounds of the distance between a region and the closest volume that it guards against, m. An upper bound below 0 is,
/// but for its sign, the distance by which the volume has to travel before it leaves the region.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DistanceBounds {
    pub(crate) lower_m: f64,
    pub(crate) upper_m: f64,
}

impl DistanceBounds {
    /// Bounds that say nothing.
    pub(crate) const UNKNOWN: Self = Self { lower_m: f64::NEG_INFINITY, upper_m: f64::INFINITY };

    /// Includes a measured pair; `overlap` returns how far the volume can travel and still touch the region, m.
    pub(crate) fn include(&mut self, pair: &Separation, overlap: impl FnOnce() -> f64) {
        if pair.distance.is_nan() {
            *self = Self::UNKNOWN;
            return;
        }
        let upper_m = if pair.distance > 0.0 { pair.distance } else { -overlap() };
        self.lower_m = self.lower_m.min(pair.lower_bound.min(pair.distance));
        self.upper_m = self.upper_m.min(upper_m);
    }

    /// The bounds after a travel of at most `travel_m` (m).
    fn widened(self, travel_m: f64) -> Self {
        Self { lower_m: self.lower_m - travel_m, upper_m: self.upper_m + travel_m }
    }
}

/// The static regions near the volumes of a robot, with bounds of their distances.
#[derive(Debug)]
pub(crate) struct RegionNeighbours {
    tree: RegionTree,
    /// Static regions without a finite box: they are always listed.
    unbounded: Vec<u32>,
    /// The listed regions, in ascending order.
    regions: Vec<u32>,
    of_region: Vec<Neighbour>,
    /// Number of the list, counted from 1.
    list: u64,
    /// Largest travel of a point of a volume since the list was made, m.
    travelled_m: f64,
    /// Travel, and reach of the laws in the tick, up to which the list is complete, m.
    complete_to_m: f64,
}

/// What is known about one region.
#[derive(Debug, Clone, Copy)]
struct Neighbour {
    /// The last list that contained the region.
    list: u64,
    /// Bounds when the list was made.
    bounds: DistanceBounds,
}

impl RegionNeighbours {
    pub(crate) fn new(config: &Configuration, placement: &Placement) -> Self {
        let reach_box = |r: usize| placement.region_box[r].inflated(config.regions[r].reach());
        let (bounded, unbounded): (Vec<usize>, Vec<usize>) = (0..config.regions.len())
            .filter(|r| config.regions[*r].follow.is_none())
            .partition(|r| reach_box(*r).extent().is_finite());
        let count = config.regions.len();
        Self {
            tree: RegionTree::new(bounded.into_iter().map(|r| (r as u32, reach_box(r))).collect()),
            unbounded: unbounded.into_iter().map(|r| r as u32).collect(),
            regions: Vec::with_capacity(count),
            of_region: vec![Neighbour { list: 0, bounds: DistanceBounds::UNKNOWN }; count],
            list: 1,
            travelled_m: 0.0,
            complete_to_m: f64::NEG_INFINITY,
        }
    }

    /// Follows the volumes to where they are `now`, at most `step_m` (m) from where they were in the previous tick.
    /// Afterwards each static region that is within `extra_reach_m` (m) of its reach is listed.
    pub(crate) fn follow(&mut self, now: &Placement, step_m: f64, extra_reach_m: f64) {
        self.travelled_m += step_m;
        // NaN makes a new list.
        if !(self.travelled_m + extra_reach_m <= self.complete_to_m) {
            self.make_list(now, extra_reach_m);
        }
    }

    /// The listed regions, in ascending order.
    pub(crate) fn regions(&self) -> &[u32] {
        &self.regions
    }

    /// Bounds of the distance of a listed region in this tick.
    #[inline]
    pub(crate) fn bounds(&self, region: u32) -> DistanceBounds {
        self.of_region[region as usize].bounds.widened(self.travelled_m)
    }

    /// Whether the region is listed.
    pub(crate) fn contains(&self, region: u32) -> bool {
        self.of_region[region as usize].list == self.list
    }

    /// Keeps the bounds of the distance of a listed region in this tick.
    pub(crate) fn keep(&mut self, region: u32, bounds: DistanceBounds) {
        self.of_region[region as usize].bounds = bounds.widened(ROUNDING_M - self.travelled_m);
    }

    fn make_list(&mut self, now: &Placement, extra_reach_m: f64) {
        let margin_m = extra_reach_m + SKIN_M;
        let Self { tree, regions, of_region, list, travelled_m, .. } = self;
        let (former, travelled) = (*list, *travelled_m);
        *list += 1;
        regions.clear();
        let mut add = |r: usize| {
            let neighbour = &mut of_region[r];
            if neighbour.list != *list {
                let is_known = neighbour.list == former;
                let bounds = if is_known { neighbour.bounds.widened(travelled) } else { DistanceBounds::UNKNOWN };
                *neighbour = Neighbour { list: *list, bounds };
                regions.push(r as u32);
            }
        };
        for volume in (0..now.volume_box.len()).filter(|v| now.attached.contains(*v)) {
            tree.visit(&now.volume_box[volume].inflated(margin_m), &mut add);
        }
        self.unbounded.iter().for_each(|r| add(*r as usize));
        self.regions.sort_unstable();
        self.travelled_m = 0.0;
        // After an infinite reach the list is made again in each tick, until it is short.
        self.complete_to_m = if margin_m.is_finite() { margin_m } else { f64::NEG_INFINITY };
    }
}
