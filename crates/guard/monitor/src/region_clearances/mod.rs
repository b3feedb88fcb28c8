//! Broad phase of a tick (VCD of Romanelli 2011): which regions have to be measured, and what was found.
//!
//! A region is kept as it was, without any query, if what is known of its distance proves that it stays in the same
//! zone, that the robot has not passed it, and that other regions request at most as much. So the result of a tick is
//! the same as if every region were measured in every tick.

use crate::override_law::OverrideLaw;
use crate::placement::Placement;
use crate::region_clearance::{MeasuredRegion, RegionClearance, RegionQuery};
use crate::region_neighbours::{DistanceBounds, RegionNeighbours};
use crate::region_state::RegionState;
use crate::region_sweep::TravelBound;
use crate::rounded_box::RoundedBox;
use crate::warm_start_cache::WarmStartCache;
use crate::zone_state::ZoneState;
use crate::{Configuration, Region, RegionId, RegionKind};

/// The clearances of all regions in one tick.
#[derive(Debug)]
pub(crate) struct RegionClearances {
    neighbours: RegionNeighbours,
    limits: Vec<RegionLimits>,
    region_bounds: Vec<Option<RoundedBox>>,
    volume_bounds: Vec<Option<RoundedBox>>,
    /// Regions that move by themselves.
    dynamic: Vec<u32>,
    warm_starts: WarmStartCache,
    of_region: Vec<RegionOfTick>,
    near: Vec<u32>,
    /// The region that requested the smallest override in the last tick.
    governing: Option<u32>,
    /// Distance beyond the reach of a region within which it could affect a volume in the last tick, m.
    extra_reach_m: f64,
    /// If true, every region near is measured in every tick, and every request is exact. For tests.
    measures_all: bool,
    tick: u64,
    pub(crate) measured_pairs: u32,
}

/// What the last ticks found of one region.
#[derive(Debug, Clone, Copy)]
struct RegionOfTick {
    /// The last tick in which a volume was near.
    near_at: u64,
    /// The last tick in which the region was kept without a query.
    kept_at: u64,
    /// Lower bound of the distance in that tick, m.
    kept_lower_m: f64,
    clearance: Option<RegionClearance>,
    /// Lower bound of the distance in the tick before `near_at`, m.
    previous_distance: f64,
}

/// What decides whether a region may be kept, in one cache line.
#[derive(Debug, Clone, Copy)]
struct RegionLimits {
    kind: RegionKind,
    warning_m: f64,
    reach_m: f64,
}

impl RegionClearances {
    pub(crate) fn new(config: &Configuration, placement: &Placement) -> Self {
        let count = config.regions.len();
        let dynamic = (0..count).filter(|r| config.regions[*r].follow.is_some());
        let unknown =
            RegionOfTick { near_at: 0, kept_at: 0, kept_lower_m: 0.0, clearance: None, previous_distance: 0.0 };
        let limits = |r: &Region| RegionLimits { kind: r.kind, warning_m: r.warning_m, reach_m: r.reach() };
        Self {
            neighbours: RegionNeighbours::new(config, placement),
            limits: config.regions.iter().map(limits).collect(),
            region_bounds: config.regions.iter().map(|r| RoundedBox::around(&r.shape)).collect(),
            volume_bounds: config.volumes.iter().map(|v| RoundedBox::around(&v.shape)).collect(),
            dynamic: dynamic.map(|r| r as u32).collect(),
            warm_starts: WarmStartCache::new(config),
            of_region: vec![unknown; count],
            near: Vec::with_capacity(count),
            governing: None,
            extra_reach_m: 0.0,
            measures_all: false,
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

    /// Measured regions with a guarded volume near, in no particular order.
    pub(crate) fn near(&self) -> &[u32] {
        &self.near
    }

    /// The region's clearance, if it was measured in this tick and a guarded volume is near.
    pub(crate) fn get(&self, region: RegionId) -> Option<&RegionClearance> {
        let found = &self.of_region[region.0];
        found.clearance.as_ref().filter(|_| found.near_at == self.tick && self.tick > 0)
    }

    /// Lower bound of the distance of a measured region in the previous tick, m.
    pub(crate) fn previous_distance(&self, region: RegionId) -> f64 {
        self.of_region[region.0].previous_distance
    }

    /// True if the region was not measured in this tick because it stays in the same zone and does not govern.
    pub(crate) fn is_kept(&self, region: RegionId) -> bool {
        self.tick > 0 && self.of_region[region.0].kept_at == self.tick
    }

    /// The regions that were kept in this tick and may have a guarded volume near.
    pub(crate) fn kept_near(&self) -> impl Iterator<Item = RegionId> + '_ {
        let is_near =
            |r: &u32| self.neighbours.bounds(*r).lower_m <= self.limits[*r as usize].reach_m + self.extra_reach_m;
        let near = self.neighbours.regions().iter().filter(move |r| is_near(r));
        near.map(|r| RegionId(*r as usize)).filter(|r| self.is_kept(*r))
    }

    /// The query of a region, as the tick makes it.
    pub(crate) fn query<'a>(
        &'a self,
        config: &'a Configuration,
        now: &'a Placement,
        law: &'a OverrideLaw<'a>,
        travel: TravelBound,
    ) -> RegionQuery<'a> {
        let (region_bounds, volume_bounds) = (&self.region_bounds, &self.volume_bounds);
        RegionQuery { config, now, law, travel, region_bounds, volume_bounds }
    }

    /// Measures each region of `states` that may have changed, against the volumes that it guards against, as far as `law`
    /// or `travel` require.
    pub(crate) fn measure(
        &mut self,
        config: &Configuration,
        states: &[RegionState],
        now: &Placement,
        law: &OverrideLaw<'_>,
        travel: TravelBound,
    ) {
        let Self { region_bounds, volume_bounds, .. } = self;
        let query = RegionQuery { config, now, law, travel, region_bounds, volume_bounds };
        let extra_reach_m = query.max_extra_reach_m();
        self.extra_reach_m = extra_reach_m;
        self.neighbours.follow(now, travel.shift, extra_reach_m);
        let mut measurement = Measurement {
            query,
            states,
            limits: &self.limits,
            neighbours: &mut self.neighbours,
            warm_starts: &mut self.warm_starts,
            of_region: &mut self.of_region,
            near: &mut self.near,
            tick: self.tick,
            pairs: 0,
            extra_reach_m,
            measures_all: self.measures_all,
            smallest: SmallestRequest { speed_override: f64::INFINITY, region: u32::MAX },
        };
        // The region that governed before is likely to govern again; then most others need no query.
        if let Some(governing) =
            self.governing.filter(|r| !measurement.measures_all && measurement.neighbours.contains(*r))
        {
            measurement.measure(governing);
        }
        for r in &self.dynamic {
            measurement.measure(*r);
        }
        measurement.measure_neighbours();
        self.measured_pairs = measurement.pairs;
        let SmallestRequest { region, .. } = measurement.smallest;
        self.governing = (region < u32::MAX).then_some(region);
    }
}

/// The smallest request of the regions that are not exchange regions; of equal ones that of the lowest region.
#[derive(Debug, Clone, Copy)]
struct SmallestRequest {
    speed_override: f64,
    region: u32,
}

impl SmallestRequest {
    fn include(&mut self, speed_override: f64, region: u32) {
        if self.is_above(speed_override, region) {
            *self = Self { speed_override, region };
        }
    }

    /// The request from which on `region` does not govern: of equal requests that of the lowest region counts.
    fn so_far(&self, region: u32) -> f64 {
        if region < self.region { self.speed_override.next_up() } else { self.speed_override }
    }

    /// True if a region that requests `speed_override` would govern instead.
    fn is_above(&self, speed_override: f64, region: u32) -> bool {
        speed_override < self.speed_override || (speed_override == self.speed_override && region < self.region)
    }
}

/// The measurement of one tick.
struct Measurement<'a> {
    query: RegionQuery<'a>,
    states: &'a [RegionState],
    limits: &'a [RegionLimits],
    neighbours: &'a mut RegionNeighbours,
    warm_starts: &'a mut WarmStartCache,
    of_region: &'a mut [RegionOfTick],
    near: &'a mut Vec<u32>,
    tick: u64,
    pairs: u32,
    /// Distance beyond the reach of a region within which it can affect a volume, m.
    extra_reach_m: f64,
    measures_all: bool,
    smallest: SmallestRequest,
}

impl Measurement<'_> {
    /// Measures or keeps each static region in the neighbourhood.
    fn measure_neighbours(&mut self) {
        for i in 0..self.neighbours.regions().len() {
            let r = self.neighbours.regions()[i];
            let bounds = self.neighbours.bounds(r);
            if self.stays(r, bounds) {
                let of_region = &mut self.of_region[r as usize];
                (of_region.kept_at, of_region.kept_lower_m) = (self.tick, bounds.lower_m);
            } else {
                self.measure(r);
            }
        }
    }

    /// True if the region's zone and the override of the tick are the same without a query of this region.
    #[inline]
    fn stays(&self, r: u32, bounds: DistanceBounds) -> bool {
        if !self.needs_query(r) || self.measures_all {
            return false;
        }
        let limits = &self.limits[r as usize];
        let step_m = self.query.travel.volumes;
        let DistanceBounds { lower_m, upper_m } = bounds;
        let zone = self.states[r as usize].presence;
        let stays_in_zone = match zone {
            ZoneState { inside: true, .. } => upper_m <= 0.0,
            ZoneState { warned: true, .. } => lower_m > step_m && upper_m <= limits.reach_m,
            // A region that the robot might have passed since the last tick is measured.
            ZoneState { .. } => lower_m > limits.warning_m + step_m,
        };
        if !stays_in_zone {
            return false;
        }
        if matches!(limits.kind, RegionKind::Exchange { .. }) {
            return lower_m > limits.reach_m + self.extra_reach_m;
        }
        let law = self.query.law;
        let least = law.least_request(limits.kind, limits.warning_m, lower_m, self.extra_reach_m);
        let programmed = law.tick.snapshot.programmed_override;
        let governs = least.speed_override < programmed && self.smallest.is_above(least.speed_override, r);
        // With a limited rate of change the override may exceed the smallest request.
        let limits_rate = self.query.config.laws.override_rate > 0.0 && least.immediate_limit < programmed;
        !governs && !limits_rate
    }

    /// True if a region counts in this tick and was not found near already.
    fn needs_query(&self, r: u32) -> bool {
        let index = r as usize;
        self.states[index].is_measured() && self.of_region[index].near_at != self.tick
    }

    /// Measures a region, once in a tick.
    fn measure(&mut self, r: u32) {
        let index = r as usize;
        if !self.needs_query(r) {
            return;
        }
        let so_far = if self.measures_all { f64::INFINITY } else { self.smallest.so_far(r) };
        let warm_starts = &mut *self.warm_starts;
        let MeasuredRegion { clearance, bounds, pairs } =
            self.query
                .measure(index, so_far, |volume, region, limit_m| warm_starts.separation(volume, region, limit_m));
        self.pairs += pairs;
        let previous_distance = self.previous_distance(index);
        if self.neighbours.contains(r) {
            self.neighbours.keep(r, bounds);
        }
        let Some(found) = clearance else { return };
        // The request of an exchange region is void while this robot holds it.
        if !matches!(self.limits[index].kind, RegionKind::Exchange { .. }) {
            self.smallest.include(found.requested_override, r);
        }
        let of_region = &mut self.of_region[index];
        *of_region = RegionOfTick { near_at: self.tick, clearance, previous_distance, ..*of_region };
        self.near.push(r);
    }

    /// Lower bound of the distance of a region in the previous tick, m.
    fn previous_distance(&self, index: usize) -> f64 {
        // Volumes that have been attached since then count as if they had been attached before.
        if !self.query.travel.shift.is_finite() {
            return 0.0;
        }
        let RegionOfTick { near_at, kept_at, kept_lower_m, clearance, .. } = &self.of_region[index];
        match clearance {
            Some(clearance) if near_at + 1 == self.tick => clearance.distance,
            _ if kept_at + 1 == self.tick => kept_lower_m.max(0.0),
            // A region that was not near in the previous tick was farther away than its reach.
            _ => self.limits[index].reach_m,
        }
    }
}

#[cfg(test)]
mod tests;
