//! Narrow phase of a tick (CPD of Romanelli 2011): the closest points of one region and the volumes that it guards
//! against, and the override that the laws request for them.

use elbowroom_proximity::{Separation, Shape, project_point};

use crate::override_law::OverrideLaw;
use crate::placement::Placement;
use crate::region_neighbours::DistanceBounds;
use crate::region_sweep::TravelBound;
use crate::rounded_box::RoundedBox;
use crate::volume_region_pair::{RequestedOverride, VolumeRegionPair};
use crate::warm_start_cache::IndexedShape;
use crate::{Configuration, RegionId, RegionKind};

/// Distance (m) beyond the reach of the laws up to which exact distances are computed: what is known of a region then
/// holds for several ticks.
const SEARCH_SKIN_M: f64 = 0.03;
/// Distance (m) beyond the reach of the laws from which a cheap lower bound is enough.
const BOUND_SKIN_M: f64 = 0.01;

/// Result of the distance queries of one region in one tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegionClearance {
    /// Distance of the closest guarded volume, m.
    pub(crate) distance: f64,
    /// The smallest override that a pair of the region requests.
    pub(crate) requested_override: f64,
    /// Upper limit of the override in this tick; a limited rate of change must not exceed it.
    pub(crate) immediate_limit: f64,
    /// The pair that requests the smallest override.
    pub(crate) governing: VolumeRegionPair,
    /// False if a volume may not be able to stop outside. Evaluated for exchange regions only; true for all others.
    pub(crate) stops_outside: bool,
}

/// What the queries of one region have found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasuredRegion {
    /// The clearance, if a guarded volume is near.
    pub(crate) clearance: Option<RegionClearance>,
    pub(crate) bounds: DistanceBounds,
    /// Number of exact distances.
    pub(crate) pairs: u32,
}

/// The query of a region in one tick.
#[derive(Clone, Copy)]
pub(crate) struct RegionQuery<'a> {
    pub(crate) config: &'a Configuration,
    pub(crate) now: &'a Placement,
    pub(crate) law: &'a OverrideLaw<'a>,
    pub(crate) travel: TravelBound,
    /// Enclosing boxes for cheap lower bounds; `None` for a shape without one.
    pub(crate) region_bounds: &'a [Option<RoundedBox>],
    pub(crate) volume_bounds: &'a [Option<RoundedBox>],
}

impl RegionQuery<'_> {
    /// Distance (m) beyond the warning zone and hysteresis of any static region within which the region can affect any
    /// volume.
    pub(crate) fn max_extra_reach_m(&self) -> f64 {
        let attached = (0..self.config.volumes.len()).filter(|v| self.now.attached.contains(*v));
        attached.map(|v| self.extra_reach_m(v, false)).fold(0.0, f64::max)
    }

    /// Distance (m) beyond its warning zone and hysteresis within which a region can affect a volume.
    #[inline]
    fn extra_reach_m(&self, volume: usize, is_dynamic: bool) -> f64 {
        let by_law = self.law.extra_reach(volume);
        // `f64::max` would drop NaN.
        let reach = if by_law.is_nan() { f64::INFINITY } else { by_law.max(self.travel.volumes) };
        if is_dynamic { reach.max(self.travel.relative) } else { reach }
    }

    /// Measures a region against the volumes that it guards against. `so_far` is the smallest request of other regions: a
    /// request of at least that need not be exact. `separation` returns the [`Separation`] of a volume and a region within
    /// a limit (m).
    pub(crate) fn measure(
        &self,
        r: usize,
        so_far: f64,
        mut separation: impl FnMut(IndexedShape<'_>, IndexedShape<'_>, f64) -> Option<Separation>,
    ) -> MeasuredRegion {
        let (config, now) = (self.config, self.now);
        let region = &config.regions[r];
        let is_dynamic = region.follow.is_some();
        let only_closest_matters = self.law.only_closest_matters();
        // What is known of a region that moves by itself is of no use in the next tick.
        let (search_skin_m, bound_skin_m) = if is_dynamic { (0.0, 0.0) } else { (SEARCH_SKIN_M, BOUND_SKIN_M) };
        let bounds = DistanceBounds { lower_m: f64::INFINITY, upper_m: f64::INFINITY };
        let mut found = MeasuredRegion { clearance: None, bounds, pairs: 0 };
        for (v, volume) in config.volumes.iter().enumerate() {
            if !now.attached.contains(v) || !volume.part.counts_for(region.guards) {
                continue;
            }
            let reach_m = region.reach() + self.extra_reach_m(v, is_dynamic);
            let (mut limit_m, mut enough_m, mut search_m) = (reach_m, reach_m + bound_skin_m, reach_m + search_skin_m);
            if let Some(clearance) = &found.clearance
                && only_closest_matters
            {
                if clearance.distance <= 0.0 {
                    break;
                }
                (limit_m, enough_m) = (limit_m.min(clearance.distance), enough_m.min(clearance.distance));
                search_m = search_m.min(clearance.distance);
            }
            let lower_m = self.lower_bound(r, v, enough_m);
            if lower_m > enough_m {
                found.bounds.lower_m = found.bounds.lower_m.min(lower_m);
                continue;
            }
            found.pairs += 1;
            let on_volume = IndexedShape { index: v, shape: &volume.shape, in_world: &now.volume_in_world[v] };
            let on_region = IndexedShape { index: r, shape: &region.shape, in_world: &now.region_in_world[r] };
            let Some(s) = separation(on_volume, on_region, search_m) else {
                found.bounds.lower_m = found.bounds.lower_m.min(search_m);
                continue;
            };
            found.bounds.include(&s, || overlap_bound(on_volume, on_region));
            if s.distance > limit_m {
                continue;
            }
            self.add(&mut found.clearance, VolumeRegionPair { region: RegionId(r), volume: v, separation: s }, so_far);
        }
        found
    }

    /// A cheap lower bound of the distance of a pair, m. It is improved until it exceeds `enough_m`.
    #[inline]
    fn lower_bound(&self, r: usize, v: usize, enough_m: f64) -> f64 {
        let now = self.now;
        let squared = now.region_box[r].distance_squared(&now.volume_box[v]);
        if squared > enough_m * enough_m {
            return squared.sqrt();
        }
        let (Some(region), Some(volume)) = (&self.region_bounds[r], &self.volume_bounds[v]) else { return 0.0 };
        let (in_world, region_in_world) = (&now.volume_in_world[v], &now.region_in_world[r]);
        let lower_m = volume.distance_bound(in_world, region, region_in_world);
        if lower_m > enough_m { lower_m } else { region.distance_bound(region_in_world, volume, in_world) }
    }

    /// Adds a pair to the clearance of its region.
    fn add(&self, to: &mut Option<RegionClearance>, pair: VolumeRegionPair, so_far: f64) {
        let of_region = to.as_ref().map_or(f64::INFINITY, |c| c.requested_override);
        let RequestedOverride { speed_override: requested_override, immediate_limit } =
            self.law.requested_override(&pair, of_region.min(so_far));
        let distance = pair.separation.distance;
        let is_exchange = matches!(self.config.regions[pair.region.0].kind, RegionKind::Exchange { .. });
        let stops_outside = !is_exchange || self.law.stops_outside(&pair);
        let Some(clearance) = to else {
            *to =
                Some(RegionClearance { distance, requested_override, immediate_limit, governing: pair, stops_outside });
            return;
        };
        let is_tie = requested_override == clearance.requested_override && distance < clearance.distance;
        if requested_override < clearance.requested_override || is_tie {
            (clearance.requested_override, clearance.governing) = (requested_override, pair);
        }
        clearance.distance = clearance.distance.min(distance);
        clearance.immediate_limit = clearance.immediate_limit.min(immediate_limit);
        clearance.stops_outside &= stops_outside;
    }
}

/// Lower bound of the distance (m) that a volume has to travel before it no longer touches a region that it touches: by
/// a ball inside the volume; 0 if it has none.
fn overlap_bound(volume: IndexedShape<'_>, region: IndexedShape<'_>) -> f64 {
    if matches!(region.shape, Shape::Mesh(_)) {
        return 0.0;
    }
    let ball = |center, radius: f64| radius - project_point(region.shape, region.in_world, center).signed_distance;
    let center = volume.in_world.translation;
    let depth = match volume.shape {
        Shape::Sphere(s) => ball(center, s.radius),
        Shape::Capsule(c) => {
            let axis = volume.in_world.rotation.z_axis();
            let along = (region.in_world.translation - center).dot(axis);
            ball(center + axis * along.clamp(-c.half_length, c.half_length), c.radius)
        }
        Shape::Cylinder(c) => ball(center, c.radius.min(c.half_length)),
        Shape::Cuboid(c) => ball(center, c.half_extents.min_element()),
        Shape::HalfSpace(_) | Shape::Hull(_) | Shape::Mesh(_) => 0.0,
    };
    depth.max(0.0)
}
