//! Queries of a monitor between its ticks.

use elbowroom_kinematics::ChainState;
use elbowroom_proximity::separation_within;
use elbowroom_spatial::Pose;

use crate::attached_volumes::AttachedVolumes;
use crate::distance_to_guarded::distance_to_guarded;
use crate::override_law::OverrideLaw;
use crate::point_motion::{LinkPoint, region_point_motion};
use crate::region_clearance::RegionClearance;
use crate::tick_context::TickContext;
use crate::warm_start_cache::IndexedShape;
use crate::zone_client::ZoneClient;
use crate::{
    Configuration, Event, ExchangeState, Fault, Monitor, RegionId, RegionKind, SlotGrants, SlotId, Snapshot,
    VirtualTcp, VolumeId,
};

impl Monitor {
    /// The fault set by [`Monitor::set_external_fault`].
    pub fn external_fault(&self) -> Option<Fault> {
        self.faults.external
    }

    /// The fault of the input of the last tick; `None` if the input was valid and the robot was measured.
    pub fn input_fault(&self) -> Option<Fault> {
        self.faults.input
    }

    /// Whether a volume is a part of the robot at present.
    pub fn is_attached(&self, volume: VolumeId) -> bool {
        volume.0 < self.config.volumes.len() && self.now.attached.contains(volume.0)
    }

    pub(crate) fn attached(&self) -> &AttachedVolumes {
        &self.now.attached
    }

    /// Whether the region is active.
    pub fn is_active(&self, region: RegionId) -> bool {
        self.regions.is_active(region)
    }

    /// The region with this name.
    pub fn region(&self, name: &str) -> Option<RegionId> {
        self.config.region(name)
    }

    /// The configuration.
    pub fn configuration(&self) -> &Configuration {
        &self.config
    }

    /// The events of the last tick.
    pub fn events(&self) -> &[Event] {
        self.log.as_slice()
    }

    /// The virtual TCPs of the last tick, whose snapshot was `s`: for every region near the robot, the point that requests
    /// the smallest override; of regions that do not govern the override, a point whose request is not smaller than that
    /// of the governing one. Regions that the tick did not have to measure are measured here; a snapshot without the
    /// sources of the configuration gives only those that it measured.
    pub fn virtual_tcps<'a>(&'a self, s: &'a Snapshot<'a>) -> impl Iterator<Item = VirtualTcp> + 'a {
        let measured = self.clearances.near().iter().map(|r| RegionId(*r as usize));
        let measured = measured.filter(|r| self.is_active(*r)).filter_map(|r| self.clearances.get(r).copied());
        let is_complete = s.sources.len() == self.config.sources.len();
        let law = is_complete.then(|| OverrideLaw::new(self.tick_context(s), self.stopping_law.as_ref()));
        let kept = law.into_iter().flat_map(move |law| {
            let kept = self.clearances.kept_near().filter(|r| self.is_active(*r));
            kept.filter_map(move |r| self.clearance_of_kept(&law, r))
        });
        measured.chain(kept).map(|clearance| self.virtual_tcp(&clearance, s))
    }

    fn tick_context<'a>(&'a self, s: &'a Snapshot<'a>) -> TickContext<'a> {
        TickContext {
            config: &self.config,
            snapshot: s,
            now: &self.now,
            predicted: self.predicted.as_ref(),
            intent: self.intent.as_ref(),
            last_override: self.last_override.unwrap_or(0.0),
        }
    }

    fn clearance_of_kept(&self, law: &OverrideLaw<'_>, region: RegionId) -> Option<RegionClearance> {
        let query = self.clearances.query(&self.config, &self.now, law, self.sweep.extra_reach_for_travel());
        let separation = |volume: IndexedShape<'_>, region: IndexedShape<'_>, limit_m| {
            separation_within(volume.shape, volume.in_world, region.shape, region.in_world, limit_m)
        };
        query.measure(region.0, f64::INFINITY, separation).clearance
    }

    /// Distance (m) from the region to the closest volume that it guards against, at the state of the last tick; `None`
    /// if it exceeds `limit` or the region is inactive. For reports; a tick does not use it.
    pub fn distance(&self, region: RegionId, limit: f64) -> Option<f64> {
        let found =
            self.is_active(region).then(|| distance_to_guarded(&self.config, &self.now, region, limit)).flatten();
        found.map(|d| d.distance)
    }

    /// Whether a guarded volume is inside the region (with hysteresis).
    pub fn is_inside(&self, region: RegionId) -> bool {
        self.regions.get(region).zone.inside
    }

    /// Whether a guarded volume is inside the region or its warning zone (with hysteresis).
    pub fn is_warned(&self, region: RegionId) -> bool {
        self.regions.get(region).zone.warned
    }

    /// Whether this robot holds the exchange region.
    pub fn holds(&self, region: RegionId) -> bool {
        self.exchange(region).is_some_and(|(client, slot)| client.holds(slot))
    }

    /// The grants that come from outside this process ([`Granted`](crate::Interlock::Granted)); `None` if the robots
    /// share an arbiter or the configuration has no exchange regions.
    pub fn slot_grants(&self) -> Option<&SlotGrants> {
        self.zone_client.as_ref()?.slot_grants()
    }

    /// State of the robot with respect to an exchange region in the last tick; `None` for any other region.
    pub fn exchange_state(&self, region: RegionId) -> Option<ExchangeState> {
        self.exchange(region).map(|(client, slot)| client.state(slot))
    }

    /// The client and the slot of an exchange region; `None` for any other region.
    fn exchange(&self, region: RegionId) -> Option<(&ZoneClient, SlotId)> {
        match (self.config.regions[region.0].kind, &self.zone_client) {
            (RegionKind::Exchange { slot }, Some(client)) => Some((client, slot)),
            _ => None,
        }
    }

    /// Whether the region stops this robot now: it is active, and forbidden or taken by another robot. An exchange
    /// region without a holder is not closed, because it is granted on approach.
    pub fn is_closed(&self, region: RegionId) -> bool {
        self.is_active(region)
            && match self.config.regions[region.0].kind {
                RegionKind::Forbidden => true,
                RegionKind::Monitored { .. } => false,
                RegionKind::Exchange { .. } => {
                    self.exchange(region).is_some_and(|(client, slot)| client.is_taken(slot))
                }
            }
    }

    /// Pose of the region's shape in the last tick.
    pub fn region_in_world(&self, region: RegionId) -> Pose {
        self.now.region_in_world[region.0]
    }

    /// Pose of a volume's shape in the last tick; for a detached volume, its pose when it was last attached.
    pub fn volume_in_world(&self, volume: VolumeId) -> Pose {
        self.now.volume_in_world[volume.0]
    }

    /// State of the chain in the last tick.
    pub fn state(&self) -> &ChainState {
        &self.now.chain
    }

    pub(crate) fn virtual_tcp(&self, clearance: &RegionClearance, s: &Snapshot) -> VirtualTcp {
        let pair = &clearance.governing;
        let (position, on_region) = (pair.separation.on_a, pair.separation.on_b);
        let link = self.config.volumes[pair.volume].link;
        let point = LinkPoint::new(&self.config, &self.now.chain, link, position);
        let region_motion = region_point_motion(&self.config.regions[pair.region.0], s.sources, on_region);
        VirtualTcp {
            region: pair.region,
            volume: VolumeId(pair.volume),
            distance_m: pair.separation.distance,
            position,
            on_region,
            velocity: point.velocity() - region_motion.velocity,
            acceleration: point.acceleration() - region_motion.acceleration,
        }
    }
}
