//! Broad and narrow phase of a tick (VCD and CPD of Romanelli 2011): which volumes are near which regions, and their
//! closest points.

use elbowroom_proximity::Separation;
use elbowroom_spatial::Vec3;

use crate::broad_phase::RegionTree;
use crate::override_law::OverrideLaw;
use crate::placement::Placement;
use crate::rounded_box::RoundedBox;
use crate::volume_region_pair::{RequestedOverride, VolumeRegionPair};
use crate::warm_start_cache::{IndexedShape, WarmStartCache};
use crate::{Configuration, RegionId, RegionKind};

/// Result of the distance queries of one region in one tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegionClearance {
    tick: u64,
    /// Distance of the closest guarded volume, m.
    pub(crate) distance: f64,
    /// Lower bound of that distance in the previous tick, m.
    pub(crate) previous_distance: f64,
    /// The smallest override that a pair of the region requests.
    pub(crate) requested_override: f64,
    /// Upper limit of the override in this tick; a limited rate of change must not exceed it.
    pub(crate) immediate_limit: f64,
    /// The pair that requests the smallest override.
    pub(crate) governing: VolumeRegionPair,
    /// False if a volume may not be able to stop outside. Evaluated for exchange regions only; true for all others.
    pub(crate) stops_outside: bool,
}

/// Largest travel since the previous tick, m; pairs within it are measured too.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TravelBound {
    /// Travel of the volumes.
    pub(crate) volumes_m: f64,
    /// Travel of volumes and dynamic regions towards each other.
    pub(crate) relative_m: f64,
}

/// The clearances of all regions in one tick.
#[derive(Debug)]
pub(crate) struct RegionClearances {
    tree: RegionTree,
    /// Enclosing boxes for cheap lower bounds; `None` for a shape without one.
    region_bounds: Vec<Option<RoundedBox>>,
    volume_bounds: Vec<Option<RoundedBox>>,
    /// Regions outside the broad-phase tree: dynamic or unbounded.
    unindexed: Vec<u32>,
    warm_starts: WarmStartCache,
    of_region: Vec<RegionClearance>,
    near: Vec<u32>,
    tick: u64,
    pub(crate) measured_pairs: u32,
}

impl RegionClearances {
    pub(crate) fn new(config: &Configuration, placement: &Placement) -> Self {
        let reach_box = |r: usize| placement.region_box[r].inflated(config.regions[r].reach());
        let is_indexed = |r: &usize| config.regions[*r].follow.is_none() && reach_box(*r).extent().is_finite();
        let (indexed, unindexed): (Vec<usize>, Vec<usize>) = (0..config.regions.len()).partition(is_indexed);
        let separation = Separation { distance: 0.0, lower_bound: 0.0, on_a: Vec3::ZERO, on_b: Vec3::ZERO };
        let unmeasured = RegionClearance {
            tick: 0,
            distance: 0.0,
            previous_distance: 0.0,
            requested_override: 0.0,
            immediate_limit: 0.0,
            governing: VolumeRegionPair { region: RegionId(0), volume: 0, separation },
            stops_outside: true,
        };
        Self {
            tree: RegionTree::new(indexed.into_iter().map(|r| (r as u32, reach_box(r))).collect()),
            region_bounds: config.regions.iter().map(|r| RoundedBox::around(&r.shape)).collect(),
            volume_bounds: config.volumes.iter().map(|v| RoundedBox::around(&v.shape)).collect(),
            unindexed: unindexed.into_iter().map(|r| r as u32).collect(),
            warm_starts: WarmStartCache::new(config),
            of_region: vec![unmeasured; config.regions.len()],
            near: Vec::with_capacity(config.regions.len()),
            tick: 0,
            measured_pairs: 0,
        }
    }

    /// Begins a new tick.
    pub(crate) fn clear(&mut self) {
        self.near.clear();
        self.tick += 1;
        self.measured_pairs = 0;
    }

    /// Regions with a guarded volume near, in no particular order.
    pub(crate) fn near(&self) -> &[u32] {
        &self.near
    }

    /// The region's clearance, if a guarded volume is near.
    pub(crate) fn get(&self, region: RegionId) -> Option<&RegionClearance> {
        let clearance = &self.of_region[region.0];
        (clearance.tick == self.tick && self.tick > 0).then_some(clearance)
    }

    /// Measures every region of `measured` against the volumes that it guards against, as far as `law` or `travel`
    /// require.
    // If it were inlined into the tick, the loop would not keep its bounds in registers.
    #[inline(never)]
    pub(crate) fn measure(
        &mut self,
        config: &Configuration,
        measured: &[bool],
        now: &Placement,
        law: &OverrideLaw<'_>,
        travel: TravelBound,
    ) {
        let mut measurement = Measurement {
            config,
            measured,
            now,
            law,
            region_bounds: &self.region_bounds,
            volume_bounds: &self.volume_bounds,
            warm_starts: &mut self.warm_starts,
            of_region: &mut self.of_region,
            near: &mut self.near,
            tick: self.tick,
            pairs: 0,
            smallest_request: f64::INFINITY,
        };
        for volume in (0..config.volumes.len()).filter(|v| now.attached.contains(*v)) {
            let extra_reach = law.extra_reach(volume).max(travel.volumes_m);
            self.tree
                .visit(&now.volume_box[volume].inflated(extra_reach), |r| measurement.visit(r, volume, extra_reach));
            let extra_reach = extra_reach.max(travel.relative_m);
            for r in &self.unindexed {
                measurement.visit(*r as usize, volume, extra_reach);
            }
        }
        self.measured_pairs = measurement.pairs;
    }
}

/// The measurement of one tick.
struct Measurement<'a> {
    config: &'a Configuration,
    measured: &'a [bool],
    now: &'a Placement,
    law: &'a OverrideLaw<'a>,
    region_bounds: &'a [Option<RoundedBox>],
    volume_bounds: &'a [Option<RoundedBox>],
    warm_starts: &'a mut WarmStartCache,
    of_region: &'a mut [RegionClearance],
    near: &'a mut Vec<u32>,
    tick: u64,
    pairs: u32,
    /// The smallest request so far of a region that is not an exchange region.
    smallest_request: f64,
}

impl Measurement<'_> {
    /// Measures one pair if it can have an effect.
    #[inline]
    fn visit(&mut self, r: usize, v: usize, extra_reach: f64) {
        let (region, volume) = (&self.config.regions[r], &self.config.volumes[v]);
        if !self.measured[r] || !volume.part.counts_for(region.guards) {
            return;
        }
        let clearance = &self.of_region[r];
        let is_first = clearance.tick != self.tick;
        let mut limit = region.reach() + extra_reach;
        if !is_first && self.law.only_closest_matters() {
            if clearance.distance <= 0.0 {
                return;
            }
            limit = limit.min(clearance.distance);
        }
        if self.is_beyond(r, v, limit) {
            return;
        }
        self.pairs += 1;
        let found = self.warm_starts.separation(
            IndexedShape { index: v, shape: &volume.shape, in_world: &self.now.volume_in_world[v] },
            IndexedShape { index: r, shape: &region.shape, in_world: &self.now.region_in_world[r] },
            limit,
        );
        let Some(separation) = found else { return };
        self.record(VolumeRegionPair { region: RegionId(r), volume: v, separation }, is_first);
    }

    /// True if cheap bounds prove that the distance of the pair exceeds `limit`.
    #[inline]
    fn is_beyond(&self, r: usize, v: usize, limit: f64) -> bool {
        let now = self.now;
        if now.region_box[r].distance_squared(&now.volume_box[v]) > limit * limit {
            return true;
        }
        let (Some(region), Some(volume)) = (&self.region_bounds[r], &self.volume_bounds[v]) else { return false };
        let (in_world, region_in_world) = (&now.volume_in_world[v], &now.region_in_world[r]);
        volume.distance_bound(in_world, region, region_in_world) > limit
            || region.distance_bound(region_in_world, volume, in_world) > limit
    }

    /// Adds a pair to the clearance of its region; `is_first` if it is the first pair of the region in this tick.
    fn record(&mut self, pair: VolumeRegionPair, is_first: bool) {
        let of_region = if is_first { f64::INFINITY } else { self.of_region[pair.region.0].requested_override };
        let RequestedOverride { speed_override: requested_override, immediate_limit } =
            self.law.requested_override(&pair, of_region.min(self.smallest_request));
        let distance = pair.separation.distance;
        let is_exchange = matches!(self.config.regions[pair.region.0].kind, RegionKind::Exchange { .. });
        // The request of an exchange region is void while this robot holds it.
        if !is_exchange {
            self.smallest_request = self.smallest_request.min(requested_override);
        }
        let stops_outside = !is_exchange || self.law.stops_outside(&pair);
        let clearance = &mut self.of_region[pair.region.0];
        if is_first {
            self.near.push(pair.region.0 as u32);
            // A region that was not near in the previous tick was farther away than its reach.
            let previous_distance = if clearance.tick + 1 == self.tick {
                clearance.distance
            } else {
                self.config.regions[pair.region.0].reach()
            };
            *clearance = RegionClearance {
                tick: self.tick,
                distance,
                previous_distance,
                requested_override,
                immediate_limit,
                governing: pair,
                stops_outside,
            };
            return;
        }
        let is_tie = requested_override == clearance.requested_override && distance < clearance.distance;
        if requested_override < clearance.requested_override || is_tie {
            (clearance.requested_override, clearance.governing) = (requested_override, pair);
        }
        clearance.distance = clearance.distance.min(distance);
        clearance.immediate_limit = clearance.immediate_limit.min(immediate_limit);
        clearance.stops_outside &= stops_outside;
    }
}
