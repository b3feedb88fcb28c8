//! VCD and CPD (S1.11): which volumes are near which regions, and their closest points.

use elbowroom_proximity::{Separation, separation_within};
use elbowroom_spatial::Vec3;

use crate::bound::RoundedBox;
use crate::broad::RegionTree;
use crate::placement::Placement;
use crate::witness::Witnesses;
use crate::{Configuration, Kind, RegionId};

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
    /// The override above which a stop would not end before the region: no limit of the override's rate delays it.
    pub(crate) at_once: f64,
    /// The pair that asks for it.
    pub(crate) asking: Pair,
    /// False where a volume may not be able to stop outside. Only asked for exchange regions; true for others.
    pub(crate) stops: bool,
}

/// All gaps of a tick.
#[derive(Debug)]
pub(crate) struct Gaps {
    tree: RegionTree,
    /// For cheap bounds, where a shape has one.
    region_bounds: Vec<Option<RoundedBox>>,
    volume_bounds: Vec<Option<RoundedBox>>,
    /// Regions that the tree cannot hold: they move, or are unbounded.
    roaming: Vec<u32>,
    witnesses: Witnesses,
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
            region_bounds: config.regions.iter().map(|r| RoundedBox::around(&r.shape)).collect(),
            volume_bounds: config.volumes.iter().map(|v| RoundedBox::around(&v.shape)).collect(),
            roaming: roaming.into_iter().map(|r| r as u32).collect(),
            witnesses: Witnesses::new(config),
            of_region: vec![
                Gap { tick: 0, distance: 0.0, asks: 0.0, at_once: 0.0, asking, stops: true };
                config.regions.len()
            ],
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
        let Self { tree, region_bounds, volume_bounds, roaming, witnesses, of_region, near, tick, measured_pairs } =
            self;
        let bounds = (region_bounds.as_slice(), volume_bounds.as_slice());
        let tick = *tick;
        let mut measuring = Measuring { config, active, now, law, bounds, witnesses, of_region, near, tick, pairs: 0 };
        for volume in 0..config.volumes.len() {
            let extra_reach = law.extra_reach(volume);
            tree.visit(&now.volume_box[volume].inflated(extra_reach), |r| measuring.visit(r, volume, extra_reach));
            for r in roaming.iter() {
                measuring.visit(*r as usize, volume, extra_reach);
            }
        }
        *measured_pairs = measuring.pairs;
    }
}

/// A tick's measuring under way.
struct Measuring<'a, L> {
    config: &'a Configuration,
    active: &'a [bool],
    now: &'a Placement,
    law: &'a L,
    /// Of the regions and of the volumes.
    bounds: (&'a [Option<RoundedBox>], &'a [Option<RoundedBox>]),
    witnesses: &'a mut Witnesses,
    of_region: &'a mut [Gap],
    near: &'a mut Vec<u32>,
    tick: u64,
    pairs: u32,
}

impl<L: PairLaw> Measuring<'_, L> {
    /// Measures one pair where it can matter.
    #[inline]
    fn visit(&mut self, r: usize, v: usize, extra_reach: f64) {
        let (region, volume) = (&self.config.regions[r], &self.config.volumes[v]);
        if !self.active[r] || !volume.part.counts_for(region.guards) {
            return;
        }
        let gap = &self.of_region[r];
        let fresh = gap.tick != self.tick;
        let mut limit = region.reach() + extra_reach;
        if !fresh && self.law.only_closest_matters() {
            if gap.distance <= 0.0 {
                return;
            }
            limit = limit.min(gap.distance);
        }
        if self.is_beyond(r, v, limit) {
            return;
        }
        self.pairs += 1;
        let (in_world, region_in_world) = (&self.now.volume_in_world[v], &self.now.region_in_world[r]);
        let (of_volume, of_region) = ((v, &volume.shape, in_world), (r, &region.shape, region_in_world));
        let found = self.witnesses.separation(of_volume, of_region, limit);
        let Some(separation) = found else { return };
        self.note(Pair { region: r, volume: v, separation }, fresh);
    }

    /// True where cheap bounds prove that the pair is farther apart than `limit`.
    #[inline]
    fn is_beyond(&self, r: usize, v: usize, limit: f64) -> bool {
        let now = self.now;
        if now.region_box[r].distance_squared(&now.volume_box[v]) > limit * limit {
            return true;
        }
        let (Some(region), Some(volume)) = (&self.bounds.0[r], &self.bounds.1[v]) else { return false };
        let (in_world, region_in_world) = (&now.volume_in_world[v], &now.region_in_world[r]);
        volume.distance_bound(in_world, region, region_in_world) > limit
            || region.distance_bound(region_in_world, volume, in_world) > limit
    }

    fn note(&mut self, pair: Pair, fresh: bool) {
        let Asked { speed_override: asks, at_once } = self.law.asks(&pair);
        let distance = pair.separation.distance;
        let exchanged = matches!(self.config.regions[pair.region].kind, Kind::Exchange { .. });
        let stops = !exchanged || self.law.stops_outside(&pair);
        let gap = &mut self.of_region[pair.region];
        if fresh {
            self.near.push(pair.region as u32);
            *gap = Gap { tick: self.tick, distance, asks, at_once, asking: pair, stops };
            return;
        }
        if asks < gap.asks || (asks == gap.asks && distance < gap.distance) {
            (gap.asks, gap.asking) = (asks, pair);
        }
        gap.distance = gap.distance.min(distance);
        gap.at_once = gap.at_once.min(at_once);
        gap.stops &= stops;
    }
}

/// What a pair asks for, 0..1.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asked {
    /// The override.
    pub(crate) speed_override: f64,
    /// The override that it must not be above in this very tick.
    pub(crate) at_once: f64,
}

impl Asked {
    /// An override that must be obeyed in this very tick.
    pub(crate) fn at_once(speed_override: f64) -> Self {
        Self { speed_override, at_once: speed_override }
    }

    /// An override that may be approached at a limited rate from at most `programmed`.
    pub(crate) fn gently(speed_override: f64, programmed: f64) -> Self {
        Self { speed_override, at_once: programmed }
    }
}

/// How a pair is judged while gaps are measured.
pub(crate) trait PairLaw {
    /// The override that a pair asks for.
    fn asks(&self, pair: &Pair) -> Asked;
    /// True where the robot, told to stop from this tick on, is sure to stop before the pair touches.
    fn stops_outside(&self, pair: &Pair) -> bool;
    /// How far (m) beyond its warning zone a region can still ask something of this volume.
    fn extra_reach(&self, volume: usize) -> f64;
    /// True where farther pairs never ask for less than closer ones.
    fn only_closest_matters(&self) -> bool;
}

/// How far a region is from the guarded volumes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Closest {
    /// Distance, m.
    pub(crate) distance: f64,
    /// Proven: it is not below this, m.
    pub(crate) lower_bound: f64,
}

/// Exact distance of a region from the guarded volumes, where it is not above `limit`.
pub(crate) fn distance(config: &Configuration, now: &Placement, region: RegionId, limit: f64) -> Option<Closest> {
    let r = region.0;
    let mut best: Option<Closest> = None;
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
            let lower_bound = best.map_or(s.lower_bound, |b| b.lower_bound.min(s.lower_bound));
            best = Some(Closest { distance: reach, lower_bound });
        }
    }
    best
}
