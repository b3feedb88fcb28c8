//! Exact distance between a region and the volumes that it guards against.

use elbowroom_proximity::separation_within;

use crate::placement::Placement;
use crate::{Configuration, RegionId};

/// A distance with a proven lower bound.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoundedDistance {
    /// Distance, m.
    pub(crate) distance: f64,
    /// Proven lower bound of the distance, m.
    pub(crate) lower_bound: f64,
}

/// Distance of a region from the closest guarded volume; `None` if it exceeds `limit` (m).
pub(crate) fn distance_to_guarded(
    config: &Configuration,
    now: &Placement,
    region: RegionId,
    limit: f64,
) -> Option<BoundedDistance> {
    let r = region.0;
    let mut best: Option<BoundedDistance> = None;
    let mut upper_bound = limit;
    for (v, volume) in config.volumes.iter().enumerate() {
        if !now.attached.contains(v) || !volume.part.counts_for(config.regions[r].guards) {
            continue;
        }
        if now.region_box[r].distance(&now.volume_box[v]) > upper_bound {
            continue;
        }
        let (in_world, region_in_world) = (&now.volume_in_world[v], &now.region_in_world[r]);
        let found = separation_within(&volume.shape, in_world, &config.regions[r].shape, region_in_world, upper_bound);
        if let Some(s) = found {
            upper_bound = upper_bound.min(s.distance);
            let lower_bound = best.map_or(s.lower_bound, |b| b.lower_bound.min(s.lower_bound));
            best = Some(BoundedDistance { distance: upper_bound, lower_bound });
        }
    }
    best
}
