//! The monitor of one robot.

use elbowroom_kinematics::ChainState;
use elbowroom_spatial::Pose;

use crate::attached_volumes::AttachedVolumes;
use crate::distance_to_guarded::distance_to_guarded;
use crate::event::EventLog;
use crate::laws::rate_limited;
use crate::override_history::OverrideRange;
use crate::override_law::{OverrideLaw, OverrideLawSettings, max_region_travel_m};
use crate::placement::{DynamicRegion, Placement};
use crate::point_motion::{LinkPoint, region_point_motion};
use crate::region_clearance::{RegionClearance, RegionClearances};
use crate::region_sweep::RegionSweep;
use crate::source_check::{SourceCheck, SourceStatus};
use crate::stopping::{StoppingInput, StoppingLaw};
use crate::tick_context::{DirectionSettings, TickContext};
use crate::watchdog::{Watchdog, WatchdogSettings};
use crate::zone_client::{RegionStatus, ZoneClient};
use crate::zone_state::{DigitalOutputs, ZoneState};
use crate::{
    AccessClass, AttachError, ConfigError, Configuration, Event, EventKind, ExchangeState, Fault, Interlock, Life,
    OverrideReason, RegionId, RegionKind, SlotGrants, SlotId, Snapshot, SwitchError, TickReport, VirtualTcp, VolumeId,
};

/// Smallest override by which actual velocities are divided to infer those of the program.
const MIN_INFERENCE_OVERRIDE: f64 = 0.01;

/// The monitor of one robot: see the [crate documentation](crate).
#[derive(Debug)]
pub struct Monitor {
    pub(crate) config: Configuration,
    pub(crate) active: Vec<bool>,
    /// Regions that are measured in this tick: the active ones, and all exchange regions of which it is known where they are.
    measured: Vec<bool>,
    pub(crate) now: Placement,
    /// The placement after the lookahead time, for the direction-aware law.
    pub(crate) predicted: Option<Placement>,
    /// The chain at the program's velocities at override 1, for the laws that need it.
    intent: Option<ChainState>,
    pub(crate) stopping_law: Option<StoppingLaw>,
    clearances: RegionClearances,
    /// The motion since the previous tick.
    pub(crate) sweep: RegionSweep,
    pub(crate) zones: Vec<ZoneState>,
    /// The same of all measured regions, the inactive ones included.
    pub(crate) presence: Vec<ZoneState>,
    /// Regions in whose warning zone the robot is, in this tick and in the previous one.
    pub(crate) warned: Vec<u32>,
    previously_warned: Vec<u32>,
    pub(crate) outputs: DigitalOutputs,
    pub(crate) log: EventLog,
    /// Regions switched since the last tick.
    switched: Vec<(RegionId, bool)>,
    /// Regions switched for this tick: the motion since the previous tick does not count for them.
    just_switched: Vec<RegionId>,
    pub(crate) watchdog: Watchdog,
    source_check: SourceCheck,
    pub(crate) zone_client: Option<ZoneClient>,
    pub(crate) last_override: Option<f64>,
    /// True where a volume was attached since the last tick: then the override does not fall at a limited rate.
    pub(crate) just_attached: bool,
    pub(crate) fault: Option<Fault>,
    /// What stops the robot besides: its host knows it, the input does not show it.
    pub(crate) external_fault: Option<Fault>,
}

/// The smallest requested override and its reason.
struct Decision<'a> {
    speed_override: f64,
    /// Upper limit in this tick, which no limit of the rate of change may exceed.
    immediate_limit: f64,
    reason: OverrideReason,
    governing: Option<&'a RegionClearance>,
}

impl Monitor {
    /// A monitor that is ready to tick: everything is allocated here. Exchange regions need the interlock that grants them.
    ///
    /// # Errors
    /// [`ConfigError::NoArbiter`] where there are exchange regions, but nothing that grants their slots;
    /// [`ConfigError::NoStoppingDistance`] where they are shared with other processes without the stopping-distance law.
    pub fn new(config: Configuration, interlock: Option<Interlock>) -> Result<Self, ConfigError> {
        let zone_client = interlock.map(|interlock| ZoneClient::new(interlock, &config)).transpose()?;
        if let (None, Some(region)) = (&zone_client, config.first_exchange()) {
            return Err(ConfigError::NoArbiter(region.name.clone()));
        }
        let (regions, laws) = (config.regions.len(), &config.laws);
        let now = Placement::new(&config);
        let needs_intent = laws.direction_aware || laws.stopping_distance.is_some();
        Ok(Self {
            active: config.regions.iter().map(|r| r.life == Life::Permanent).collect(),
            measured: vec![false; regions],
            predicted: laws.direction_aware.then(|| Placement::new(&config)),
            intent: needs_intent.then(|| ChainState::new(&config.chain)),
            stopping_law: laws.stopping_distance.as_ref().map(|s| StoppingLaw::new(&config, s)),
            clearances: RegionClearances::new(&config, &now),
            sweep: RegionSweep::new(&config),
            zones: vec![ZoneState::default(); regions],
            presence: vec![ZoneState::default(); regions],
            warned: Vec::with_capacity(regions),
            previously_warned: Vec::with_capacity(regions),
            outputs: DigitalOutputs::new(),
            log: EventLog::with_capacity(8 * regions + 16),
            switched: Vec::with_capacity(2 * regions + 16),
            source_check: SourceCheck::new(config.sources.len()),
            just_switched: Vec::with_capacity(2 * regions + 16),
            watchdog: Watchdog::new(&config.chain, laws, WatchdogSettings::default()),
            last_override: None,
            just_attached: false,
            fault: None,
            external_fault: None,
            now,
            zone_client,
            config,
        })
    }

    /// The largest speed override that the laws allow in this tick, and its reason. Never allocates, locks or panics.
    pub fn tick(&mut self, s: &Snapshot) -> TickReport {
        self.begin();
        let since_last_s = self.watchdog.since_last(s);
        let valid = self
            .watchdog
            .check(s, self.config.sources.len(), self.override_range(s.now_s))
            .and_then(|()| self.check_sources(s));
        if let Err(fault) = valid {
            return self.stop(s, fault);
        }
        // After a fault the override rises from 0 at its largest rate, however long the fault lasted.
        let dt_s = if self.fault.is_some() { 0.0 } else { since_last_s };
        if self.fault.take().is_some() {
            self.log.push(None, EventKind::Recovered);
        }
        let is_continuous = dt_s > 0.0 && dt_s <= self.config.laws.stale_s;
        if !is_continuous {
            self.sweep.reset();
        }
        self.measure(s, dt_s);
        if self.stopping_law.as_ref().is_some_and(StoppingLaw::brakes_too_little) {
            return self.stop(s, Fault::Braking);
        }
        self.update_zones();
        if let Some(zone_client) = &mut self.zone_client {
            let Self { active, measured, presence, clearances, log, .. } = self;
            let status = |r: RegionId| RegionStatus {
                is_active: active[r.0],
                is_measured: measured[r.0],
                zone: presence[r.0],
                stops_outside: clearances.get(r.0).is_none_or(|c| c.stops_outside),
            };
            zone_client.update(status, s.now_s, log);
        }
        self.conclude(s, dt_s)
    }

    /// Switches a temporary region; takes effect with the next tick.
    ///
    /// # Errors
    /// [`SwitchError`] where the region is permanent or the access class is too low.
    pub fn switch(&mut self, region: RegionId, on: bool, who: AccessClass) -> Result<(), SwitchError> {
        let r = &self.config.regions[region.0];
        if r.life == Life::Permanent {
            return Err(SwitchError::Permanent(r.name.clone()));
        }
        let needed = r.life.needed_class();
        if who < needed {
            return Err(SwitchError::Class { region: r.name.clone(), who, needed });
        }
        if self.active[region.0] != on {
            self.active[region.0] = on;
            if let (true, RegionKind::Exchange { slot }, Some(zone_client)) = (on, r.kind, &self.zone_client) {
                zone_client.invalidate(slot);
            }
            if self.switched.len() < self.switched.capacity() {
                self.switched.push((region, on));
            }
        }
        Ok(())
    }

    /// Attaches a volume that is not [always](crate::Presence::Always) there, such as an object that the robot has gripped: from
    /// the next tick on it moves with its link at the pose `in_link`, and counts as every other volume. One that is attached
    /// already moves there. Call it before the robot moves with it. Never allocates.
    ///
    /// ```
    /// # use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
    /// # use elbowroom_monitor::{Configuration, ConfigurationParts, Laws, Monitor, Region, Snapshot, Volume, VolumeId};
    /// # use elbowroom_proximity::{Shape, Sphere};
    /// # use elbowroom_spatial::{Pose, Vec3};
    /// # let rail = Joint { name: "rail".into(), kind: JointKind::Prismatic, parent: LinkId(0), child: LinkId(1),
    /// #     origin: Pose::IDENTITY, axis: Vec3::X, limits: Limits::range(0.0, 2.0), mimic: None };
    /// # let chain = Chain::new("rail", vec!["base".into(), "carriage".into()], vec![rail])?;
    /// let ball = Shape::Sphere(Sphere { radius: 0.2 });
    /// let volumes = vec![Volume::tcp(LinkId(1), Vec3::ZERO), Volume::gripped("ball", LinkId(1), ball)];
    /// # let pillar = Region::sphere("pillar", Vec3::X * 2.0, 0.5).warning(0.4);
    /// # let mut monitor = Monitor::new(Configuration::new(ConfigurationParts { robot: "rail".into(),
    /// #     base_in_world: Pose::IDENTITY, chain, volumes, regions: vec![pillar], sources: vec![], laws: Laws::default() })?, None)?;
    /// // Half a metre before a pillar with a warning zone of 0.4 m; then with a ball of 0.2 m in the hand.
    /// assert_eq!(monitor.tick(&Snapshot::stationary(0.0, &[1.0])).speed_override, 1.0);
    /// monitor.attach(VolumeId(1), &Pose::IDENTITY)?;
    /// let report = monitor.tick(&Snapshot::stationary(0.002, &[1.0]));
    /// assert!((report.speed_override - 0.75).abs() < 1e-12 && report.governing.is_some_and(|g| g.volume == VolumeId(1)));
    /// monitor.detach(VolumeId(1))?;
    /// assert_eq!(monitor.tick(&Snapshot::stationary(0.004, &[1.0])).speed_override, 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`AttachError`] where the volume is always there or unknown, or the pose is not finite; then nothing changes, and the
    /// robot must not move with the object.
    pub fn attach(&mut self, volume: VolumeId, in_link: &Pose) -> Result<(), AttachError> {
        self.now.attached.attach(&self.config, volume, in_link)?;
        if let Some(predicted) = &mut self.predicted {
            predicted.attached.attach(&self.config, volume, in_link)?;
        }
        self.sweep.attach(&self.config, volume, in_link)?;
        if let Some(law) = &mut self.stopping_law {
            law.attach(&self.config, volume, in_link);
        }
        self.just_attached = true;
        Ok(())
    }

    /// Detaches a volume: it does not count from the next tick on. Call it when the robot has let go. Never allocates.
    ///
    /// # Errors
    /// [`AttachError`] where the volume is always there or unknown; then nothing changes.
    pub fn detach(&mut self, volume: VolumeId) -> Result<(), AttachError> {
        self.now.attached.detach(&self.config, volume)?;
        if let Some(predicted) = &mut self.predicted {
            predicted.attached.detach(&self.config, volume)?;
        }
        self.sweep.detach(&self.config, volume)
    }

    /// Forgets where the robot was: the next joint values may be anywhere, and are not [too fast](Fault::TooFast). Call it where
    /// the robot is known to be at rest, after it was moved while nobody looked. Never allocates.
    ///
    /// ```
    /// # use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
    /// # use elbowroom_monitor::{Configuration, ConfigurationParts, Laws, Monitor, Snapshot, Volume};
    /// # use elbowroom_spatial::{Pose, Vec3};
    /// # let rail = Joint { name: "rail".into(), kind: JointKind::Prismatic, parent: LinkId(0), child: LinkId(1),
    /// #     origin: Pose::IDENTITY, axis: Vec3::X, limits: Limits::range(0.0, 2.0), mimic: None };
    /// # let chain = Chain::new("rail", vec!["base".into(), "carriage".into()], vec![rail])?;
    /// # let mut monitor = Monitor::new(Configuration::new(ConfigurationParts { robot: "rail".into(), chain,
    /// #     base_in_world: Pose::IDENTITY, volumes: vec![Volume::tcp(LinkId(1), Vec3::ZERO)], regions: vec![],
    /// #     sources: vec![], laws: Laws::default() })?, None)?;
    /// monitor.tick(&Snapshot::stationary(0.0, &[0.0]));
    /// assert_eq!(monitor.tick(&Snapshot::stationary(0.002, &[1.0])).speed_override, 0.0); // 1 m in 2 ms
    /// monitor.forget_position();
    /// assert_eq!(monitor.tick(&Snapshot::stationary(0.004, &[1.0])).speed_override, 1.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn forget_position(&mut self) {
        self.watchdog.forget_position();
        self.sweep.reset();
    }

    /// Stops the robot, from the next tick on, for a fault that its host knows and the input does not show; `None` ends it. The
    /// robot is measured as before, and rises from override 0 afterwards. Set it here instead of lowering the override of a
    /// report: the monitor has to know which override the robot executes. Never allocates.
    pub fn set_external_fault(&mut self, fault: Option<Fault>) {
        self.external_fault = fault;
    }

    /// The fault of [`Monitor::set_external_fault`].
    pub fn external_fault(&self) -> Option<Fault> {
        self.external_fault
    }

    /// What is wrong with the input of the last tick. `None` where it was valid and the robot was measured.
    pub fn input_fault(&self) -> Option<Fault> {
        self.fault
    }

    /// True where a volume is a part of the robot at present.
    pub fn is_attached(&self, volume: VolumeId) -> bool {
        volume.0 < self.config.volumes.len() && self.now.attached.contains(volume.0)
    }

    pub(crate) fn attached(&self) -> &AttachedVolumes {
        &self.now.attached
    }

    /// True where the region is active.
    pub fn is_active(&self, region: RegionId) -> bool {
        self.active[region.0]
    }

    /// The region of this name.
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

    /// The virtual TCPs of the last tick: for every region near the robot the point that requests the smallest override.
    pub fn virtual_tcps<'a>(&'a self, s: &'a Snapshot<'a>) -> impl Iterator<Item = VirtualTcp> + 'a {
        let active = self.clearances.near().iter().map(|r| *r as usize).filter(|r| self.active[*r]);
        active.filter_map(|r| self.clearances.get(r)).map(|c| self.virtual_tcp(c, s))
    }

    /// Distance (m) of the region to the closest volume that it guards against, at the state of the last tick; `None` where
    /// it exceeds `limit` or the region is inactive. Not part of the tick: for reports.
    pub fn distance(&self, region: RegionId, limit: f64) -> Option<f64> {
        let found =
            self.active[region.0].then(|| distance_to_guarded(&self.config, &self.now, region, limit)).flatten();
        found.map(|d| d.distance)
    }

    /// True where a guarded volume is inside the region (with hysteresis).
    pub fn is_inside(&self, region: RegionId) -> bool {
        self.zones[region.0].inside
    }

    /// True where a guarded volume is inside the region or its warning zone (with hysteresis).
    pub fn is_warned(&self, region: RegionId) -> bool {
        self.zones[region.0].warned
    }

    /// True where this robot holds the exchange region.
    pub fn holds(&self, region: RegionId) -> bool {
        self.exchange(region).is_some_and(|(client, slot)| client.holds(slot))
    }

    fn may_enter(&self, region: RegionId, now_s: f64) -> bool {
        self.exchange(region).is_some_and(|(client, slot)| client.may_enter(slot, now_s))
    }

    /// The grants that come from outside of the process: those of [`Interlock::Granted`]. `None` where the robots share an
    /// arbiter, and without exchange regions.
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

    /// True where the region stops this robot now: it is active, and forbidden or taken by another robot. An exchange region
    /// without a holder is not closed: it is granted on approach.
    pub fn is_closed(&self, region: RegionId) -> bool {
        self.active[region.0]
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

    /// Pose of a volume's shape in the last tick; of a detached volume, where it was attached last.
    pub fn volume_in_world(&self, volume: VolumeId) -> Pose {
        self.now.volume_in_world[volume.0]
    }

    /// State of the chain in the last tick.
    pub fn state(&self) -> &ChainState {
        &self.now.chain
    }

    fn begin(&mut self) {
        self.log.clear();
        self.just_switched.clear();
        for (region, on) in self.switched.drain(..) {
            self.just_switched.push(region);
            self.log.push(Some(region), if on { EventKind::On } else { EventKind::Off });
        }
        self.clearances.clear();
    }

    fn check_sources(&mut self, s: &Snapshot) -> Result<(), Fault> {
        self.source_check.update(&self.config.sources, s.sources, s.now_s, self.config.laws.stale_s);
        for (r, measured) in self.measured.iter_mut().enumerate() {
            *measured = self.active[r] || matches!(self.config.regions[r].kind, RegionKind::Exchange { .. });
        }
        for DynamicRegion { region, source } in &self.now.dynamic_regions {
            let region = RegionId(*region);
            match self.source_check.status(source.0) {
                SourceStatus::Valid => {}
                _ if !self.active[region.0] => self.measured[region.0] = false,
                SourceStatus::Lost => return Err(Fault::Source { region }),
                SourceStatus::Jumped => return Err(Fault::SourceJump { region }),
            }
        }
        Ok(())
    }

    fn stop(&mut self, s: &Snapshot, fault: Fault) -> TickReport {
        if self.fault != Some(fault) {
            let region = match fault {
                Fault::Source { region } | Fault::SourceJump { region } => Some(region),
                _ => None,
            };
            self.log.push(region, EventKind::Fault);
        }
        self.fault = Some(fault);
        self.last_override = Some(0.0);
        if let Some(law) = self.stopping_law.as_mut().filter(|_| fault.has_valid_time()) {
            law.record_override(s.now_s, 0.0);
        }
        TickReport {
            stamp_s: s.stamp_s,
            speed_override: 0.0,
            reason: OverrideReason::Fault(fault),
            governing: None,
            outputs: self.outputs.bits,
            measured_pairs: 0,
        }
    }

    /// The overrides that the robot may be executing.
    fn override_range(&self, now_s: f64) -> OverrideRange {
        self.stopping_law.as_ref().map_or(OverrideRange::default(), |law| law.override_range(now_s))
    }

    fn record_override(&mut self, s: &Snapshot, speed_override: f64) {
        self.last_override = Some(speed_override);
        if let Some(law) = &mut self.stopping_law {
            law.record_override(s.now_s, speed_override);
        }
    }

    fn measure(&mut self, s: &Snapshot, dt_s: f64) {
        let Self {
            config,
            measured,
            now,
            predicted,
            intent,
            stopping_law,
            watchdog,
            clearances,
            sweep,
            last_override,
            ..
        } = self;
        let direction = DirectionSettings::default();
        now.place(config, s, watchdog.velocity());
        sweep.advance_to(config, now, dt_s, s.sources);
        if let Some(state) = intent {
            state.q.copy_from_slice(s.q);
            match s.intent {
                Some(velocity) => state.qd.copy_from_slice(velocity),
                None => infer_intent(&mut state.qd, &now.chain.qd, last_override.unwrap_or(1.0)),
            }
            config.chain.forward_motion(state);
            if let Some(predicted) = predicted {
                predicted.place_ahead(config, s, &state.qd, direction.lookahead_s);
            }
        }
        if let (Some(stopping_law), Some(intent)) = (stopping_law.as_mut(), intent.as_ref()) {
            let input = StoppingInput {
                now: &now.chain,
                intent,
                program_is_known: s.intent.is_some(),
                now_s: s.now_s,
                stamp_s: s.stamp_s,
                programmed_override: s.programmed_override,
                uncertain_s: watchdog.velocity_uncertain_s(),
                unchanged_s: watchdog.max_unchanged_s(),
                volume_in_world: &now.volume_in_world,
                attached: &now.attached,
            };
            stopping_law.begin(config, &input);
        }
        let tick = TickContext {
            config,
            snapshot: s,
            now,
            predicted: predicted.as_ref(),
            intent: intent.as_ref(),
            last_override: last_override.unwrap_or(0.0),
            direction,
        };
        let override_law = OverrideLaw {
            tick,
            stopping_law: stopping_law.as_ref(),
            max_region_travel_m: max_region_travel_m(now, s, stopping_law.as_ref()),
            settings: OverrideLawSettings::default(),
        };
        clearances.measure(config, measured, now, &override_law, sweep.extra_reach_for_travel());
    }

    fn update_zones(&mut self) {
        std::mem::swap(&mut self.warned, &mut self.previously_warned);
        self.warned.clear();
        let Self {
            config,
            active,
            clearances,
            sweep,
            just_switched,
            zones,
            presence,
            warned,
            previously_warned,
            outputs,
            log,
            ..
        } = self;
        let left = previously_warned.iter().filter(|r| clearances.get(**r as usize).is_none());
        for r in clearances.near().iter().chain(left) {
            let (id, region) = (RegionId(*r as usize), &config.regions[*r as usize]);
            let from = presence[id.0];
            let mut to = from.next(clearances.get(id.0).map_or(f64::INFINITY, |c| c.distance), region);
            if let Some(clearance) = clearances.get(id.0).filter(|_| !to.inside && !just_switched.contains(&id))
                && let Some(passed_m) =
                    sweep.passed(config, id, [clearance.previous_distance, clearance.distance], to.warned)
            {
                // A region that was passed is reported for one tick.
                to = from.next(passed_m, region);
            }
            presence[id.0] = to;
            let reported = if active[id.0] { to } else { ZoneState::default() };
            if reported != zones[id.0] {
                outputs.change(id, region, zones[id.0], reported, log);
                zones[id.0] = reported;
            }
            if to.warned {
                warned.push(*r);
            }
        }
    }

    fn conclude(&mut self, s: &Snapshot, dt_s: f64) -> TickReport {
        let decision = self.decide(s);
        let governing = decision.governing.map(|clearance| self.virtual_tcp(clearance, s));
        let (requested, mut reason) = (decision.speed_override, decision.reason);
        let previous = self.last_override.unwrap_or(requested);
        let mut speed_override = rate_limited(previous, requested, self.config.laws.override_rate, dt_s);
        if self.just_attached || governing.is_some_and(|g| g.distance_m <= 0.0) {
            speed_override = speed_override.min(requested);
        }
        speed_override = speed_override.min(s.programmed_override);
        speed_override = speed_override.min(decision.immediate_limit);
        if speed_override < requested {
            reason = OverrideReason::Rate;
        }
        self.just_attached = false;
        self.record_override(s, speed_override);
        TickReport {
            stamp_s: s.stamp_s,
            speed_override,
            reason,
            governing,
            outputs: self.outputs.bits,
            measured_pairs: self.clearances.measured_pairs,
        }
    }

    /// The minimum over all regions (Romanelli 2011, eq. 4); of equal requests that of the region of lowest index.
    fn decide(&self, s: &Snapshot) -> Decision<'_> {
        let v0 = s.programmed_override;
        let mut decision =
            Decision { speed_override: v0, immediate_limit: v0, reason: OverrideReason::Free, governing: None };
        if let Some(fault) = self.external_fault {
            let reason = OverrideReason::Fault(fault);
            return Decision { speed_override: 0.0, immediate_limit: 0.0, reason, governing: None };
        }
        if let Some(region) = self.zone_client.as_ref().and_then(ZoneClient::halted_by) {
            let (reason, governing) = (OverrideReason::Halted(region), self.clearances.get(region.0));
            return Decision { speed_override: 0.0, immediate_limit: 0.0, reason, governing };
        }
        for r in self.clearances.near().iter().filter(|r| self.active[**r as usize]) {
            let Some(clearance) = self.clearances.get(*r as usize) else { continue };
            let id = RegionId(*r as usize);
            if self.may_enter(id, s.now_s) {
                continue;
            }
            decision.immediate_limit = decision.immediate_limit.min(clearance.immediate_limit);
            let requested = clearance.requested_override;
            let is_tie =
                requested == decision.speed_override && decision.governing.is_some_and(|g| id.0 < g.governing.region);
            if !(requested < decision.speed_override || is_tie) {
                continue;
            }
            let reason = match self.config.regions[id.0].kind {
                RegionKind::Forbidden => OverrideReason::Region(id),
                RegionKind::Monitored { .. } => OverrideReason::SpeedZone(id),
                RegionKind::Exchange { .. } => OverrideReason::Waiting(id),
            };
            (decision.speed_override, decision.reason, decision.governing) = (requested, reason, Some(clearance));
        }
        decision
    }

    fn virtual_tcp(&self, clearance: &RegionClearance, s: &Snapshot) -> VirtualTcp {
        let pair = &clearance.governing;
        let (position, on_region) = (pair.separation.on_a, pair.separation.on_b);
        let link = self.config.volumes[pair.volume].link;
        let point = LinkPoint::new(&self.config, &self.now.chain, link, position);
        let region_motion = region_point_motion(&self.config.regions[pair.region], s.sources, on_region);
        VirtualTcp {
            region: RegionId(pair.region),
            volume: VolumeId(pair.volume),
            distance_m: pair.separation.distance,
            position,
            on_region,
            velocity: point.velocity() - region_motion.velocity,
            acceleration: point.acceleration() - region_motion.acceleration,
        }
    }
}

/// Infers the program's velocities at override 1 from the actual ones, which result from the last override.
fn infer_intent(intent: &mut [f64], real: &[f64], last_override: f64) {
    let scale = 1.0 / last_override.max(MIN_INFERENCE_OVERRIDE);
    intent.iter_mut().zip(real).for_each(|(full, v)| *full = v * scale);
}
