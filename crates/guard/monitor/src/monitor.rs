//! The monitor of one robot.

use elbowroom_kinematics::ChainState;
use elbowroom_spatial::Pose;

use crate::decision::Decision;
use crate::event::EventLog;
use crate::laws::rate_limited;
use crate::override_history::OverrideRange;
use crate::override_law::OverrideLaw;
use crate::placement::{DynamicRegion, Placement};
use crate::region_clearances::RegionClearances;
use crate::region_states::RegionStates;
use crate::region_sweep::RegionSweep;
use crate::source_check::{SourceCheck, SourceStatus};
use crate::stopping::{StoppingInput, StoppingLaw};
use crate::tick_context::{LOOKAHEAD_S, TickContext};
use crate::watchdog::{Watchdog, WatchdogSettings};
use crate::zone_client::{RegionStatus, ZoneClient};
use crate::{
    AccessClass, AttachError, ConfigError, Configuration, EventKind, Fault, Interlock, Life, OverrideReason, RegionId,
    RegionKind, Snapshot, SwitchError, TickReport, VolumeId,
};

/// Smallest override by which the actual velocities are divided to infer the program's velocities.
const MIN_INFERENCE_OVERRIDE: f64 = 0.01;

/// The monitor of one robot: see the [crate documentation](crate).
#[derive(Debug)]
pub struct Monitor {
    pub(crate) config: Configuration,
    pub(crate) regions: RegionStates,
    pub(crate) now: Placement,
    /// The placement after the lookahead time, for the direction-aware law.
    pub(crate) predicted: Option<Placement>,
    /// The chain at the program's velocities at override 1, for the laws that need it.
    pub(crate) intent: Option<ChainState>,
    pub(crate) stopping_law: Option<StoppingLaw>,
    pub(crate) clearances: RegionClearances,
    /// The motion since the previous tick.
    pub(crate) sweep: RegionSweep,
    pub(crate) log: EventLog,
    pub(crate) watchdog: Watchdog,
    source_check: SourceCheck,
    pub(crate) zone_client: Option<ZoneClient>,
    pub(crate) last_override: Option<f64>,
    /// True if a volume was attached since the last tick: then the override falls at once, without its rate limit.
    pub(crate) just_attached: bool,
    pub(crate) faults: Faults,
}

/// Faults that stop the robot, whatever its regions request.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Faults {
    /// Fault of the input of the last tick.
    pub(crate) input: Option<Fault>,
    /// Fault reported by the host, which the input does not show.
    pub(crate) external: Option<Fault>,
}

impl Monitor {
    /// Creates a monitor that is ready to tick, and allocates all of its memory. Exchange regions need the interlock
    /// that grants them.
    ///
    /// # Errors
    /// [`ConfigError::NoArbiter`] if an exchange region has no interlock that grants its slot;
    /// [`ConfigError::NoStoppingDistance`] if exchange regions are shared with other processes without the
    /// stopping-distance law.
    pub fn new(config: Configuration, interlock: Option<Interlock>) -> Result<Self, ConfigError> {
        let zone_client = interlock.map(|interlock| ZoneClient::new(interlock, &config)).transpose()?;
        if let (None, Some(region)) = (&zone_client, config.first_exchange()) {
            return Err(ConfigError::NoArbiter(region.name.clone()));
        }
        let laws = &config.laws;
        let now = Placement::new(&config);
        let needs_intent = laws.direction_aware || laws.stopping_distance.is_some();
        Ok(Self {
            regions: RegionStates::new(&config),
            predicted: laws.direction_aware.then(|| Placement::new(&config)),
            intent: needs_intent.then(|| ChainState::new(&config.chain)),
            stopping_law: laws.stopping_distance.as_ref().map(|s| StoppingLaw::new(&config, s)),
            clearances: RegionClearances::new(&config, &now),
            sweep: RegionSweep::new(&config),
            log: EventLog::with_capacity(8 * config.regions.len() + 16),
            source_check: SourceCheck::new(config.sources.len()),
            watchdog: Watchdog::new(&config.chain, laws, WatchdogSettings::default()),
            last_override: None,
            just_attached: false,
            faults: Faults::default(),
            now,
            zone_client,
            config,
        })
    }

    /// Computes the largest speed override that the laws allow in this tick, and its reason. Never allocates, locks or
    /// panics.
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
        let dt_s = if self.faults.input.is_some() { 0.0 } else { since_last_s };
        if self.faults.input.take().is_some() {
            self.log.push(None, EventKind::Recovered);
        }
        let is_continuous = dt_s > 0.0 && dt_s <= self.config.laws.stale_s;
        if !is_continuous {
            self.sweep.reset();
        }
        self.measure(s, dt_s);
        // A robot that brakes too little is stopped, and is where it is.
        self.regions.update_grids(&self.config, &self.now);
        if self.stopping_law.as_ref().is_some_and(StoppingLaw::brakes_too_little) {
            return self.stop(s, Fault::Braking);
        }
        self.regions.update(&self.config, &self.clearances, &mut self.sweep, &mut self.log);
        if let Some(zone_client) = &mut self.zone_client {
            let Self { regions, clearances, log, .. } = self;
            let status = |r: RegionId| RegionStatus {
                is_active: regions.is_active(r),
                is_measured: regions.get(r).is_measured(),
                zone: regions.get(r).presence,
                stops_outside: clearances.get(r).is_none_or(|c| c.stops_outside),
            };
            zone_client.update(status, s.now_s, log);
        }
        self.conclude(s, dt_s)
    }

    /// Switches a temporary region on or off, from the next tick on.
    ///
    /// # Errors
    /// [`SwitchError`] if the region is permanent or the access class is too low.
    pub fn switch(&mut self, region: RegionId, on: bool, who: AccessClass) -> Result<(), SwitchError> {
        let r = &self.config.regions[region.0];
        if r.life == Life::Permanent {
            return Err(SwitchError::Permanent(r.name.clone()));
        }
        let needed = r.life.needed_class();
        if who < needed {
            return Err(SwitchError::Class { region: r.name.clone(), who, needed });
        }
        let is_change = self.regions.switch(region, on);
        if let (true, true, RegionKind::Exchange { slot }, Some(client)) = (is_change, on, r.kind, &self.zone_client) {
            client.invalidate(slot);
        }
        Ok(())
    }

    /// Attaches a volume that is not [always](crate::Presence::Always) there, such as an object that the robot has
    /// gripped. From the next tick on it moves with its link at the pose `in_link` and counts like every other volume. A
    /// volume that is attached already moves to `in_link`. Call it before the robot moves with the object. Never
    /// allocates.
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
    /// #     base_in_world: Pose::IDENTITY, chain, volumes, regions: vec![pillar], sources: vec![], grids: vec![], laws: Laws::default() })?, None)?;
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
    /// [`AttachError`] if the volume is always there or unknown, or the pose is not finite; then nothing changes, and the
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

    /// Detaches a volume, which does not count from the next tick on. Call it when the robot has let go. Never
    /// allocates.
    ///
    /// # Errors
    /// [`AttachError`] if the volume is always there or unknown; then nothing changes.
    pub fn detach(&mut self, volume: VolumeId) -> Result<(), AttachError> {
        self.now.attached.detach(&self.config, volume)?;
        if let Some(predicted) = &mut self.predicted {
            predicted.attached.detach(&self.config, volume)?;
        }
        self.sweep.detach(&self.config, volume)
    }

    /// The tool centre point of the tool that is mounted; `None` if no tool is.
    pub fn tcp(&self) -> Option<VolumeId> {
        self.now.tcp()
    }

    /// Forgets where the robot was: the next joint values may be anywhere without being [too fast](Fault::TooFast). Call
    /// it when the robot is known to be at rest, after it was moved without ticks. Never allocates.
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
    /// #     sources: vec![], grids: vec![], laws: Laws::default() })?, None)?;
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

    /// Stops the robot from the next tick on, for a fault that its host knows and the input does not show; `None` ends
    /// the fault. The monitor still measures the robot; after the fault the override rises from 0. Use this instead of
    /// lowering the override of a report: the monitor has to know which override the robot executes. Never allocates.
    pub fn set_external_fault(&mut self, fault: Option<Fault>) {
        self.faults.external = fault;
    }

    fn begin(&mut self) {
        self.log.clear();
        self.regions.begin(&mut self.log);
        self.clearances.clear();
    }

    fn check_sources(&mut self, s: &Snapshot) -> Result<(), Fault> {
        self.source_check.update(&self.config.sources, s.sources, s.now_s, self.config.laws.stale_s);
        for &DynamicRegion { region, source } in &self.now.dynamic_regions {
            let status = self.source_check.status(source.0);
            self.regions.set_placed(region, matches!(status, SourceStatus::Valid));
            match status {
                SourceStatus::Valid => {}
                _ if !self.regions.is_active(region) => {}
                SourceStatus::Lost => return Err(Fault::Source { region }),
                SourceStatus::Jumped => return Err(Fault::SourceJump { region }),
            }
        }
        Ok(())
    }

    fn stop(&mut self, s: &Snapshot, fault: Fault) -> TickReport {
        if !self.faults.input.is_some_and(|before| before.is_same_as(fault)) {
            let region = match fault {
                Fault::Source { region } | Fault::SourceJump { region } => Some(region),
                _ => None,
            };
            self.log.push(region, EventKind::Fault);
        }
        self.faults.input = Some(fault);
        self.last_override = Some(0.0);
        if let Some(law) = self.stopping_law.as_mut().filter(|_| fault.has_valid_time()) {
            law.record_override(s.now_s, 0.0);
        }
        TickReport {
            stamp_s: s.stamp_s,
            speed_override: 0.0,
            reason: OverrideReason::Fault(fault),
            governing: None,
            outputs: self.regions.output_bits(),
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
            regions,
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
                predicted.place_ahead(config, s, &state.qd, LOOKAHEAD_S);
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
        };
        let law = OverrideLaw::new(tick, stopping_law.as_ref());
        clearances.measure(config, regions.as_slice(), now, &law, sweep.extra_reach_for_travel());
    }

    fn conclude(&mut self, s: &Snapshot, dt_s: f64) -> TickReport {
        let (client, regions) = (self.zone_client.as_ref(), &self.regions);
        let decision = match self.faults.external {
            Some(fault) => Decision::stop(OverrideReason::Fault(fault), None),
            None => Decision::of(&self.config, regions, &self.clearances, client, s),
        };
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
            outputs: self.regions.output_bits(),
            measured_pairs: self.clearances.measured_pairs,
        }
    }
}

/// Infers the program's velocities at override 1 from the actual velocities, which result from the last override.
fn infer_intent(intent: &mut [f64], real: &[f64], last_override: f64) {
    let scale = 1.0 / last_override.max(MIN_INFERENCE_OVERRIDE);
    intent.iter_mut().zip(real).for_each(|(full, v)| *full = v * scale);
}
