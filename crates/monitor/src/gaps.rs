//! VCD and CPD (S1.11): which volumes are near which regions, and their closest points.

use elbowroom_proximity::{Separation, separation_within};
use elbowroom_spatial::Vec3;

use crate::broad::RegionTree;
use crate::placement::Placement;
use crate::{Configuration, RegionId};

/// A volume near a region.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pair {
    pub(crate) region: usize,
    pub(crate) volume: usize,
    /// `on_a` lies on the volume, `on_b` on the region.
    pub(crate) separation: Separation,
}

/// What is known about a region in this tick.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Gap {
    tick: u64,
    /// Distance of the closest guarded volume, m.
    pub(crate) distance: f64,
    /// The override that the region asks for.
    pub(crate) asks: f64,
    /// The pair that asks for it.
    pub(crate) asking: Pair,
}

/// All gaps of a tick.
#[derive(Debug)]
pub(crate) struct Gaps {
    tree: RegionTree,
    /// Regions that the tree cannot hold: they move, or are unbounded.
    roaming: Vec<u32>,
    of_region: Vec<Gap>,
    near: Vec<u32>,
    tick: u64,
    pub(crate) measured_pairs: u32,
}

impl Gaps {
    pub(crate) fn new(config: &Configuration, placement: &Placement) -> Self {
        let boxed = |r: usize| placement.region_box[r].inflated(config.regions[r].reach());
        let fits_tree = |r: &usize| config.regions[*r].follow.is_none() && boxed(*r).extent().is_finite();
        let (fixed, roaming): (Vec<usize>, Vec<usize>) = (0..config.regions.len()).partition(fits_tree);
        let nowhere = Separation { distance: 0.0, lower_bound: 0.0, on_a: Vec3::ZERO, on_b: Vec3::ZERO };
        let asking = Pair { region: 0, volume: 0, separation: nowhere };
        Self {
            tree: RegionTree::new(fixed.into_iter().map(|r| (r as u32, boxed(r))).collect()),
            roaming: roaming.into_iter().map(|r| r as u32).collect(),
            of_region: vec![Gap { tick: 0, distance: 0.0, asks: 0.0, asking }; config.regions.len()],
            near: Vec::with_capacity(config.regions.len()),
            tick: 0,
            measured_pairs: 0,
        }
    }

    /// Forgets the tick before.
    pub(crate) fn clear(&mut self) {
        self.near.clear();
        self.tick += 1;
        self.measured_pairs = 0;
    }

    /// Regions that a guarded volume is near to, in no particular order.
    pub(crate) fn near(&self) -> &[u32] {
        &self.near
    }

    /// The region's gap, where anything is near.
    pub(crate) fn get(&self, region: usize) -> Option<&Gap> {
        let gap = &self.of_region[region];
        (gap.tick == self.tick && self.tick > 0).then_some(gap)
    }

    /// Measures every active region against the volumes it guards. `law` says which override a pair asks for, and how
    /// much farther than the warning zone a volume must be looked at.
    pub(crate) fn measure(&mut self, config: &Configuration, active: &[bool], now: &Placement, law: &impl PairLaw) {
        let Self { tree, roaming, of_region: gaps, near, tick, measured_pairs } = self;
        for (v, volume) in config.volumes.iter().enumerate() {
            let extra = law.extra_reach(v);
            let mut visit = |r: usize| {
                let region = &config.regions[r];
                if !active[r] || !volume.part.counts_for(region.guards) {
                    return;
                }
                let fresh = gaps[r].tick != *tick;
                let mut limit = region.reach() + extra;
                if !fresh && law.only_closest_matters() {
                    if gaps[r].distance <= 0.0 {
                        return;
                    }
                    limit = limit.min(gaps[r].distance);
                }
                if now.region_box[r].distance_squared(&now.volume_box[v]) > limit * limit {
                    return;
                }
                *measured_pairs += 1;
                let (in_world, region_in_world) = (&now.volume_in_world[v], &now.region_in_world[r]);
                let found = separation_within(&volume.shape, in_world, &region.shape, region_in_world, limit);
                let Some(separation) = found else { return };
                let pair = Pair { region: r, volume: v, separation };
                if fresh {
                    near.push(r as u32);
                    gaps[r] = Gap { tick: *tick, distance: separation.distance, asks: law.asks(&pair), asking: pair };
                    return;
                }
                let gap = &mut gaps[r];
                let asks = law.asks(&pair);
                let closer = separation.distance < gap.distance;
                if asks < gap.asks || (asks == gap.asks && closer) {
                    (gap.asks, gap.asking) = (asks, pair);
                }
                gap.distance = gap.distance.min(separation.distance);
            };
            tree.visit(&now.volume_box[v].inflated(extra), &mut visit);
            for r in roaming.iter() {
                visit(*r as usize);
            }
        }
    }
}

/// How a pair is judged while gaps are measured.
pub(crate) trait PairLaw {
    /// The override that a pair asks for, 0..1.
    fn asks(&self, pair: &Pair) -> f64;
    /// How far (m) beyond its warning zone a region can still ask something of this volume.
    fn extra_reach(&self, volume: usize) -> f64;
    /// True where farther pairs never ask for less than closer ones.
    fn only_closest_matters(&self) -> bool;
}

/// Exact distance of a region from the guarded volumes, where it is not above `limit`.
pub(crate) fn distance(config: &Configuration, now: &Placement, region: RegionId, limit: f64) -> Option<f64> {
    let r = region.0;
    let mut best = None;
    let mut reach = limit;
    for (v, volume) in config.volumes.iter().enumerate() {
        if !volume.part.counts_for(config.regions[r].guards) {
            continue;
        }
        if now.region_box[r].distance(&now.volume_box[v]) > reach {
            continue;
        }
        let (in_world, region_in_world) = (&now.volume_in_world[v], &now.region_in_world[r]);
        let found = separation_within(&volume.shape, in_world, &config.regions[r].shape, region_in_world, reach);
        if let Some(s) = found {
            reach = reach.min(s.distance);
            best = Some(reach);
        }
    }
    best
}
