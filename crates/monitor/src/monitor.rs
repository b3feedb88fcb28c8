//! The monitor of one robot.

use std::sync::Arc;

use elbowroom_kinematics::{ChainState, JointKind};
use elbowroom_spatial::{Pose, Vec3};

use crate::commands::Obeyed;
use crate::events::EventLog;
use crate::gaps::{self, Gap, Gaps};
use crate::laws::rate_limited;
use crate::placement::{Placement, region_point_motion};
use crate::presence::{Outputs, Presence};
use crate::seat::{ExchangeState, Seat};
use crate::source_watch::{SourceWatch, Trust};
use crate::stopping::{StoppingLaw, TickState};
use crate::sweep::Sweep;
use crate::verdict::{Judge, LOOKAHEAD_S, fastest_region};
use crate::watchdog::Watchdog;
use crate::{
    AccessClass, Board, ConfigError, Configuration, Event, EventKind, Fault, Kind, Life, Reason, RegionId, RobotSlot,
    Snapshot, SwitchError, TickReport, VirtualTcp,
};

/// Watches one robot: see the [crate documentation](crate).
#[derive(Debug)]
pub struct Monitor {
    config: Configuration,
    active: Vec<bool>,
    now: Placement,
    /// A moment later, for the direction-aware law.
    soon: Option<Placement>,
    /// At the program's own speed, for the laws that need it.
    intent: Option<ChainState>,
    stopping: Option<StoppingLaw>,
    gaps: Gaps,
    /// The way here from the tick before.
    sweep: Sweep,
    presence: Vec<Presence>,
    /// Regions in whose warning zone the robot is.
    warned: Vec<u32>,
    warned_before: Vec<u32>,
    outputs: Outputs,
    log: EventLog,
    /// Switched since the last tick.
    switched: Vec<(RegionId, bool)>,
    /// Switched on for this tick: they were not there on the way to it.
    fresh: Vec<RegionId>,
    watchdog: Watchdog,
    source_watch: SourceWatch,
    seat: Option<Seat>,
    last_override: Option<f64>,
    fault: Option<Fault>,
}

/// The smallest override asked for, and by whom.
struct Verdict<'a> {
    speed_override: f64,
    /// The override that no limit of its rate may keep it above.
    at_once: f64,
    reason: Reason,
    gap: Option<&'a Gap>,
}

impl Monitor {
    /// A monitor that is ready to tick: everything is allocated here. Exchange regions need the board that is shared
    /// with the other robots, and this robot's place on it.
    ///
    /// # Errors
    /// [`ConfigError::NoBoard`] where there are exchange regions, but no board that has their slots.
    pub fn new(config: Configuration, board: Option<(Arc<Board>, RobotSlot)>) -> Result<Self, ConfigError> {
        let seat = board.and_then(|(board, robot)| Seat::new(board, robot, &config));
        if let (None, Some(region)) = (&seat, config.first_exchange()) {
            return Err(ConfigError::NoBoard(region.name.clone()));
        }
        let (regions, laws) = (config.regions.len(), &config.laws);
        let now = Placement::new(&config);
        let needs_intent = laws.direction_aware || laws.stopping_distance.is_some();
        Ok(Self {
            active: config.regions.iter().map(|r| r.life == Life::Permanent).collect(),
            soon: laws.direction_aware.then(|| Placement::new(&config)),
            intent: needs_intent.then(|| ChainState::new(&config.chain)),
            stopping: laws.stopping_distance.as_ref().map(|s| StoppingLaw::new(&config, s)),
            gaps: Gaps::new(&config, &now),
            sweep: Sweep::new(&config),
            presence: vec![Presence::default(); regions],
            warned: Vec::with_capacity(regions),
            warned_before: Vec::with_capacity(regions),
            outputs: Outputs::new(),
            log: EventLog::with_capacity(8 * regions + 16),
            switched: Vec::with_capacity(2 * regions + 16),
            source_watch: SourceWatch::new(config.sources.len()),
            fresh: Vec::with_capacity(2 * regions + 16),
            watchdog: Watchdog::new(&config.chain, laws),
            last_override: None,
            fault: None,
            now,
            seat,
            config,
        })
    }

    /// How fast may the robot go now, and why. Never allocates, locks or panics.
    pub fn tick(&mut self, s: &Snapshot) -> TickReport {
        self.begin();
        let since_last_s = self.watchdog.since_last(s);
        let trusted = self
            .watchdog
            .check(s, self.config.sources.len(), self.obeyed(s.now_s))
            .and_then(|()| self.check_sources(s));
        if let Err(fault) = trusted {
            return self.stop(s, fault);
        }
        // After a fault the override rises from 0 at its largest rate, however long the fault lasted.
        let dt_s = if self.fault.is_some() { 0.0 } else { since_last_s };
        if self.fault.take().is_some() {
            self.log.push(None, EventKind::Recovered);
        }
        let known = dt_s > 0.0 && dt_s <= self.config.laws.stale_s;
        if !known {
            // Nobody saw the way here.
            self.sweep.forget();
        }
        self.measure(s, dt_s);
        if self.stopping.as_ref().is_some_and(StoppingLaw::brakes_too_little) {
            return self.stop(s, Fault::Braking);
        }
        self.update_presence();
        if let Some(seat) = &mut self.seat {
            let Self { active, presence, gaps, log, .. } = self;
            let stops = |r: usize| gaps.get(r).is_none_or(|g| g.stops);
            seat.update(|r| (active[r.0], presence[r.0], stops(r.0)), s.now_s, log);
        }
        self.conclude(s, dt_s)
    }

    /// Switches a temporary region; takes effect with the next tick.
    ///
    /// # Errors
    /// [`SwitchError`] where the region is permanent or the class may not.
    pub fn switch(&mut self, region: RegionId, on: bool, who: AccessClass) -> Result<(), SwitchError> {
        let r = &self.config.regions[region.0];
        if r.life == Life::Permanent {
            return Err(SwitchError::Permanent(r.name.clone()));
        }
        let needed = AccessClass::needed_for(r.life);
        if who < needed {
            return Err(SwitchError::Class { region: r.name.clone(), who, needed });
        }
        if self.active[region.0] != on {
            self.active[region.0] = on;
            if let (true, Kind::Exchange { slot }, Some(seat)) = (on, r.kind, &self.seat) {
                seat.forget(slot);
            }
            if self.switched.len() < self.switched.capacity() {
                self.switched.push((region, on));
            }
        }
        Ok(())
    }

    /// True where the region counts.
    pub fn is_active(&self, region: RegionId) -> bool {
        self.active[region.0]
    }

    /// The region of this name.
    pub fn region(&self, name: &str) -> Option<RegionId> {
        self.config.region(name)
    }

    /// What it was built from.
    pub fn configuration(&self) -> &Configuration {
        &self.config
    }

    /// What changed in the last tick.
    pub fn events(&self) -> &[Event] {
        self.log.as_slice()
    }

    /// The virtual TCPs of the last tick: for every region near the robot the point that asks most of it.
    pub fn virtual_tcps<'a>(&'a self, s: &'a Snapshot<'a>) -> impl Iterator<Item = VirtualTcp> + 'a {
        self.gaps.near().iter().filter_map(|r| self.gaps.get(*r as usize)).map(|gap| self.virtual_tcp(gap, s))
    }

    /// Distance (m) of the region to the closest volume it guards at the last tick's state; `None` where it is farther
    /// than `limit` or the region is inactive. Not part of the tick: for reports.
    pub fn distance(&self, region: RegionId, limit: f64) -> Option<f64> {
        let found = self.active[region.0].then(|| gaps::distance(&self.config, &self.now, region, limit)).flatten();
        found.map(|closest| closest.distance)
    }

    /// True where a guarded volume is inside the region (with hysteresis).
    pub fn is_inside(&self, region: RegionId) -> bool {
        self.presence[region.0].inside
    }

    /// True where a guarded volume is inside the region or its warning zone (with hysteresis).
    pub fn is_warned(&self, region: RegionId) -> bool {
        self.presence[region.0].warned
    }

    /// True where this robot holds the exchange region.
    pub fn holds(&self, region: RegionId) -> bool {
        match self.config.regions[region.0].kind {
            Kind::Exchange { slot } => self.seat.as_ref().is_some_and(|seat| seat.holds(slot)),
            Kind::Forbidden | Kind::Monitored { .. } => false,
        }
    }

    fn may_enter(&self, region: RegionId, now_s: f64) -> bool {
        match self.config.regions[region.0].kind {
            Kind::Exchange { slot } => self.seat.as_ref().is_some_and(|seat| seat.may_enter(slot, now_s)),
            Kind::Forbidden | Kind::Monitored { .. } => false,
        }
    }

    /// How the robot stood to an exchange region in the last tick; `None` for any other region.
    pub fn exchange_state(&self, region: RegionId) -> Option<ExchangeState> {
        match self.config.regions[region.0].kind {
            Kind::Exchange { slot } => self.seat.as_ref().map(|seat| seat.state(slot)),
            Kind::Forbidden | Kind::Monitored { .. } => None,
        }
    }

    /// True where the region stops this robot now: it is active, and forbidden or in the hands of another robot. An exchange
    /// region that nobody holds is open: it is granted when it is come to.
    pub fn is_closed(&self, region: RegionId) -> bool {
        self.active[region.0]
            && match self.config.regions[region.0].kind {
                Kind::Forbidden => true,
                Kind::Monitored { .. } => false,
                Kind::Exchange { slot } => self.seat.as_ref().is_some_and(|seat| seat.is_taken(slot)),
            }
    }

    /// Where the region's shape stood in the last tick.
    pub fn region_in_world(&self, region: RegionId) -> Pose {
        self.now.region_in_world[region.0]
    }

    /// Where a volume's shape stood in the last tick.
    pub fn volume_in_world(&self, volume: usize) -> Pose {
        self.now.volume_in_world[volume]
    }

    /// The chain in the last tick.
    pub fn state(&self) -> &ChainState {
        &self.now.chain
    }

    fn begin(&mut self) {
        self.log.clear();
        self.fresh.clear();
        for (region, on) in self.switched.drain(..) {
            self.fresh.push(region);
            self.log.push(Some(region), if on { EventKind::On } else { EventKind::Off });
        }
        self.gaps.clear();
    }

    fn check_sources(&mut self, s: &Snapshot) -> Result<(), Fault> {
        self.source_watch.look(&self.config.sources, s.sources, s.now_s, self.config.laws.stale_s);
        for (r, source) in self.now.riders.iter().filter(|(r, _)| self.active[*r]) {
            let region = RegionId(*r);
            match self.source_watch.trust(*source) {
                Trust::Believed => {}
                Trust::Lost => return Err(Fault::Source { region }),
                Trust::Jumped => return Err(Fault::SourceJump { region }),
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
        if let Some(law) = self.stopping.as_mut().filter(|_| fault.knows_the_time()) {
            law.told(s.now_s, 0.0);
        }
        TickReport {
            stamp_s: s.stamp_s,
            speed_override: 0.0,
            reason: Reason::Fault(fault),
            governing: None,
            outputs: self.outputs.bits,
            measured_pairs: 0,
        }
    }

    /// The overrides that the robot may be obeying.
    fn obeyed(&self, now_s: f64) -> Obeyed {
        self.stopping.as_ref().map_or(Obeyed::default(), |law| law.obeyed(now_s))
    }

    /// Takes note of an answer.
    fn answer(&mut self, s: &Snapshot, speed_override: f64) {
        self.last_override = Some(speed_override);
        if let Some(law) = &mut self.stopping {
            law.told(s.now_s, speed_override);
        }
    }

    fn measure(&mut self, s: &Snapshot, dt_s: f64) {
        let Self { config, active, now, soon, intent, stopping, watchdog, gaps, sweep, last_override, .. } = self;
        now.place(config, s, watchdog.velocity());
        sweep.tick(config, now, dt_s, s.sources);
        if let Some(state) = intent {
            state.q.copy_from_slice(s.q);
            match s.intent {
                Some(wanted) => state.qd.copy_from_slice(wanted),
                None => at_full_override(&mut state.qd, &now.chain.qd, last_override.unwrap_or(1.0)),
            }
            config.chain.forward_motion(state);
            if let Some(soon) = soon {
                soon.place_ahead(config, s, &state.qd, LOOKAHEAD_S);
            }
        }
        let law = config.laws.stopping_distance.as_ref().zip(stopping.as_mut()).zip(intent.as_ref());
        let stopping = law.map(|((stopping, law), intent)| {
            let tick = TickState {
                now: &now.chain,
                intent,
                program_is_known: s.intent.is_some(),
                now_s: s.now_s,
                stamp_s: s.stamp_s,
                programmed_override: s.programmed_override,
                uncertain_s: watchdog.velocity_uncertain_s(),
                unnoticed_s: watchdog.unnoticed_s(),
                volume_in_world: &now.volume_in_world,
            };
            law.begin(config, stopping, &tick);
            (stopping, &*law)
        });
        let last_override = last_override.unwrap_or(0.0);
        let (soon, intent) = (soon.as_ref(), intent.as_ref());
        let region_speed_m_s = fastest_region(now, s.sources);
        let judge = Judge { config, snapshot: s, now, soon, intent, last_override, stopping, region_speed_m_s };
        gaps.measure(config, active, now, &judge, sweep.reach());
    }

    fn update_presence(&mut self) {
        std::mem::swap(&mut self.warned, &mut self.warned_before);
        self.warned.clear();
        let Self { config, gaps, sweep, fresh, presence, warned, warned_before, outputs, log, .. } = self;
        let left = warned_before.iter().filter(|r| gaps.get(**r as usize).is_none());
        for r in gaps.near().iter().chain(left) {
            let (id, region) = (RegionId(*r as usize), &config.regions[*r as usize]);
            let from = presence[id.0];
            let mut to = from.next(gaps.get(id.0).map_or(f64::INFINITY, |g| g.distance), region);
            if let Some(gap) = gaps.get(id.0).filter(|_| !to.inside && !fresh.contains(&id))
                && let Some(passed_m) = sweep.passed(config, id, [gap.before, gap.distance], to.warned)
            {
                // It is told for one tick; the next begins from where the robot is then.
                to = from.next(passed_m, region);
            }
            if to != from {
                outputs.change(id, region, from, to, log);
                presence[id.0] = to;
            }
            if to.warned {
                warned.push(*r);
            }
        }
    }

    fn conclude(&mut self, s: &Snapshot, dt_s: f64) -> TickReport {
        let verdict = self.verdict(s);
        let governing = verdict.gap.map(|gap| self.virtual_tcp(gap, s));
        let (wanted, mut reason) = (verdict.speed_override, verdict.reason);
        let previous = self.last_override.unwrap_or(wanted);
        let mut speed_override = rate_limited(previous, wanted, self.config.laws.override_rate, dt_s);
        if governing.is_some_and(|g| g.distance_m <= 0.0) {
            speed_override = speed_override.min(wanted);
        }
        speed_override = speed_override.min(s.programmed_override);
        speed_override = speed_override.min(verdict.at_once);
        if speed_override < wanted {
            reason = Reason::Rate;
        }
        self.answer(s, speed_override);
        TickReport {
            stamp_s: s.stamp_s,
            speed_override,
            reason,
            governing,
            outputs: self.outputs.bits,
            measured_pairs: self.gaps.measured_pairs,
        }
    }

    /// The minimum over all regions (S1, eq. 4); the region of lowest index where several ask for the same.
    fn verdict(&self, s: &Snapshot) -> Verdict<'_> {
        let v0 = s.programmed_override;
        let mut verdict = Verdict { speed_override: v0, at_once: v0, reason: Reason::Free, gap: None };
        for r in self.gaps.near() {
            let Some(gap) = self.gaps.get(*r as usize) else { continue };
            let id = RegionId(*r as usize);
            if self.may_enter(id, s.now_s) {
                continue;
            }
            verdict.at_once = verdict.at_once.min(gap.at_once);
            let tie = gap.asks == verdict.speed_override && verdict.gap.is_some_and(|g| id.0 < g.asking.region);
            if !(gap.asks < verdict.speed_override || tie) {
                continue;
            }
            let reason = match self.config.regions[id.0].kind {
                Kind::Forbidden => Reason::Region(id),
                Kind::Monitored { .. } => Reason::SpeedZone(id),
                Kind::Exchange { .. } => Reason::Waiting(id),
            };
            (verdict.speed_override, verdict.reason, verdict.gap) = (gap.asks, reason, Some(gap));
        }
        verdict
    }

    fn virtual_tcp(&self, gap: &Gap, s: &Snapshot) -> VirtualTcp {
        let pair = &gap.asking;
        let (position, on_region) = (pair.separation.on_a, pair.separation.on_b);
        let (velocity, acceleration) = self.now.point_motion(&self.config, pair.volume, position);
        let (region_velocity, region_acceleration): (Vec3, Vec3) =
            region_point_motion(&self.config.regions[pair.region], s.sources, on_region);
        VirtualTcp {
            region: RegionId(pair.region),
            volume: pair.volume,
            distance_m: pair.separation.distance,
            position,
            on_region,
            velocity: velocity - region_velocity,
            acceleration: acceleration - region_acceleration,
        }
    }
}

/// What the program asks for at override 1, guessed from the real velocities where it does not say: they are what the
/// last override made of it.
fn at_full_override(full: &mut [f64], real: &[f64], last_override: f64) {
    let scale = 1.0 / last_override.max(0.01);
    full.iter_mut().zip(real).for_each(|(f, v)| *f = v * scale);
}

impl Configuration {
    /// Joints without a rated speed in the model: their plausibility is judged by a general bound.
    pub fn joints_without_speed(&self) -> impl Iterator<Item = &str> {
        self.chain.active_joints().iter().map(|j| &self.chain.joints()[j.0]).filter_map(|joint| {
            (joint.kind != JointKind::Fixed && joint.limits.velocity.is_none()).then_some(joint.name.as_str())
        })
    }
}
