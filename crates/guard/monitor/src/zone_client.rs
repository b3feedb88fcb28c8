//! A monitor's client of the interlock for its exchange regions.

use crate::event::EventLog;
use crate::zone_state::ZoneState;
use crate::{
    ConfigError, Configuration, EventKind, ExchangeState, Grant, Interlock, Occupancy, RegionId, RegionKind, RobotSlot,
    SlotGrants, SlotId, ZoneArbiter,
};

/// The result of a tick for one region.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegionStatus {
    /// True if the region is active. A region that is switched off limits nothing, but a robot in it keeps its slot.
    pub(crate) is_active: bool,
    /// False if the source that the region follows is lost: then the region's position is unknown.
    pub(crate) is_measured: bool,
    pub(crate) zone: ZoneState,
    /// True if the robot can stop outside the region.
    pub(crate) stops_outside: bool,
}

/// The interlock client of one robot.
#[derive(Debug)]
pub(crate) struct ZoneClient {
    interlock: Interlock,
    slots: Vec<SlotSession>,
    /// True if the robot's deceleration is stated: only then can a moving robot be proven to stop outside.
    proves_stops: bool,
    /// Time of the last update, s.
    updated_s: Option<f64>,
}

/// Time without an update after which a robot before a region does not go on with a grant that has ended, s: the validity
/// of grants, after which another guard of the robot may have given its slot up.
const PAUSE_S: f64 = 0.05;

/// One slot, as used by the robot.
#[derive(Debug)]
struct SlotSession {
    slot: SlotId,
    regions: Vec<RegionId>,
    occupancy: Occupancy,
    /// True if a region of the slot is active and the robot is in it, in its warning zone or unable to stop outside.
    is_near_active_region: bool,
    /// The region whose halt the robot obeys: the first active one. A region that is switched off limits nothing.
    first_active: Option<RegionId>,
    grant: Option<Grant>,
    state: SlotState,
    /// Time since which the robot has held the slot while outside all warning zones.
    left_s: Option<f64>,
}

/// Time (s) for which the slot's regions do not limit a robot that has left but cannot be proven to stop outside.
/// The robot keeps its slot; after this time the regions limit its override until it can stop. Most robots are far
/// enough away by then.
const LEAVING_S: f64 = 0.25;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SlotState {
    Away,
    Held,
    Waiting,
    Deadlock,
}

impl ZoneClient {
    /// # Errors
    /// [`ConfigError`] if the interlock lacks a slot or the robot, or if a setting that the interlock needs is missing.
    pub(crate) fn new(interlock: Interlock, config: &Configuration) -> Result<Self, ConfigError> {
        let proves_stops = config.laws.stopping_distance.is_some();
        let mut slots: Vec<SlotSession> = Vec::new();
        for (r, region) in config.regions.iter().enumerate() {
            let RegionKind::Exchange { slot } = region.kind else { continue };
            let has_slot = match &interlock {
                Interlock::Shared(arbiter, robot) => slot.0 < arbiter.slots() && robot.0 < arbiter.robots(),
                Interlock::Granted(_) if !proves_stops => {
                    return Err(ConfigError::NoStoppingDistance(region.name.clone()));
                }
                Interlock::Granted(grants) => slot.0 < grants.slots(),
            };
            if !has_slot {
                return Err(ConfigError::NoArbiter(region.name.clone()));
            }
            match slots.iter_mut().find(|u| u.slot == slot) {
                Some(known) => known.regions.push(RegionId(r)),
                None => slots.push(SlotSession::new(slot, RegionId(r))),
            }
            if let Interlock::Shared(arbiter, robot) = &interlock {
                arbiter.register(slot, *robot);
            }
        }
        Ok(Self { interlock, slots, proves_stops, updated_s: None })
    }

    /// Publishes the robot's occupancy and requests the slots that it is near. A tick with invalid input does not call this:
    /// the published occupancy and the held slots stay as they are.
    pub(crate) fn update(&mut self, status: impl Fn(RegionId) -> RegionStatus, now_s: f64, log: &mut EventLog) {
        let has_paused = self.updated_s.replace(now_s).is_some_and(|before_s| now_s - before_s > PAUSE_S);
        for session in &mut self.slots {
            session.observe(&status, self.proves_stops, now_s);
        }
        if let Interlock::Shared(arbiter, robot) = &self.interlock {
            exchange(arbiter, *robot, &mut self.slots, now_s);
        }
        for session in &mut self.slots {
            let state = match &self.interlock {
                Interlock::Shared(arbiter, robot) => session.shared_state(arbiter, *robot),
                Interlock::Granted(grants) => session.granted_state(grants.may_enter(session.slot), has_paused),
            };
            if state != session.state {
                session.log_change(state, log);
                session.state = state;
            }
            if let Interlock::Granted(grants) = &self.interlock {
                let SlotSession { slot, occupancy, is_near_active_region, .. } = *session;
                grants.found(slot, occupancy, session.exchange_state(), is_near_active_region);
            }
        }
    }

    /// Continues from the client of a former monitor of the same robot: copies what it holds, and where the robot was
    /// found.
    pub(crate) fn continue_from(&mut self, former: &Self) {
        self.updated_s = former.updated_s;
        for session in &mut self.slots {
            let Some(before) = former.slots.iter().find(|s| s.slot == session.slot) else { continue };
            let SlotSession { occupancy, is_near_active_region, grant, state, left_s, .. } = *before;
            (session.occupancy, session.is_near_active_region, session.grant) =
                (occupancy, is_near_active_region, grant);
            (session.state, session.left_s) = (state, left_s);
        }
    }

    /// The grants that the caller writes; `None` if the robots share an arbiter.
    pub(crate) fn slot_grants(&self) -> Option<&SlotGrants> {
        if let Interlock::Granted(grants) = &self.interlock { Some(grants) } else { None }
    }

    /// Invalidates the published occupancy of a slot, because one of its regions was switched on.
    pub(crate) fn invalidate(&self, slot: SlotId) {
        if let Interlock::Shared(arbiter, robot) = &self.interlock {
            arbiter.invalidate(slot, *robot);
        }
    }

    /// True if another robot holds or occupies the slot. A robot in another process counts only if this robot is refused
    /// or halted because of it.
    pub(crate) fn is_taken(&self, slot: SlotId) -> bool {
        match &self.interlock {
            Interlock::Shared(arbiter, robot) => {
                let others = || (0..arbiter.robots()).map(RobotSlot).filter(|r| r != robot);
                match arbiter.holder(slot) {
                    Some(holder) => holder != *robot,
                    None => others().any(|r| arbiter.occupancy(slot, r).occupies()),
                }
            }
            Interlock::Granted(grants) => {
                let is_refused = |s: &SlotSession| s.slot == slot && s.state == SlotState::Waiting;
                grants.must_halt(slot) || self.slots.iter().any(is_refused)
            }
        }
    }

    /// An active region that halts the robot because another robot was found inside.
    pub(crate) fn halted_by(&self) -> Option<RegionId> {
        let Interlock::Granted(grants) = &self.interlock else { return None };
        self.slots.iter().filter(|s| grants.must_halt(s.slot)).find_map(|s| s.first_active)
    }

    pub(crate) fn state(&self, slot: SlotId) -> ExchangeState {
        let session = self.slots.iter().find(|s| s.slot == slot);
        session.map_or(ExchangeState::Outside, SlotSession::exchange_state)
    }

    pub(crate) fn holds(&self, slot: SlotId) -> bool {
        self.slots.iter().any(|s| s.slot == slot && s.state == SlotState::Held)
    }

    /// True if the slot's regions do not limit this robot: it holds the slot and has not been outside for longer than
    /// [`LEAVING_S`].
    pub(crate) fn may_enter(&self, slot: SlotId, now_s: f64) -> bool {
        let has_left = |s: &SlotSession| s.left_s.is_some_and(|left_s| now_s - left_s > LEAVING_S);
        self.slots.iter().any(|s| s.slot == slot && s.state == SlotState::Held && !has_left(s))
    }
}

/// Publishes the occupancy of all slots before the first request, because it may let other robots be granted a slot
/// and may require this robot to yield.
fn exchange(arbiter: &ZoneArbiter, robot: RobotSlot, sessions: &mut [SlotSession], now_s: f64) {
    for session in &*sessions {
        arbiter.publish(session.slot, robot, session.occupancy, now_s);
    }
    for session in sessions {
        // Near a region that is switched off the robot needs no slot, but it keeps a slot that it holds.
        let keeps = session.occupancy > Occupancy::Outside && arbiter.holder(session.slot) == Some(robot);
        let requests = session.is_near_active_region || keeps;
        session.grant = requests.then(|| arbiter.request(session.slot, robot, now_s));
    }
}

impl SlotSession {
    fn new(slot: SlotId, region: RegionId) -> Self {
        Self {
            slot,
            regions: vec![region],
            occupancy: Occupancy::Unknown,
            is_near_active_region: false,
            first_active: None,
            grant: None,
            state: SlotState::Away,
            left_s: None,
        }
    }

    /// Finds where the robot is with respect to all regions of the slot, including regions that are switched off.
    fn observe(&mut self, status: &impl Fn(RegionId) -> RegionStatus, proves_stops: bool, now_s: f64) {
        // Without a stated deceleration, nothing can be proven for a moving robot. Until the slot is granted, the warning
        // law is assumed to keep the robot outside.
        let held = self.state == SlotState::Held;
        let occupancy = |region: RegionStatus| {
            let can_stop = region.stops_outside || !(proves_stops || held && region.zone.warned);
            region.zone.occupancy(can_stop)
        };
        let all = || self.regions.iter().map(|r| status(*r));
        let is_known = all().all(|region| region.is_measured);
        let found = all().filter(|region| region.is_measured).map(occupancy).max().unwrap_or(Occupancy::Unknown);
        let is_near = all().any(|r| r.is_active && occupancy(r) > Occupancy::Outside);
        let has_left = held && !all().any(|region| region.zone.warned);
        self.first_active = self.regions.iter().find(|r| status(**r).is_active).copied();
        self.occupancy = if is_known || found.occupies() { found } else { Occupancy::Unknown };
        self.is_near_active_region = is_near;
        self.left_s = if has_left { self.left_s.or(Some(now_s)) } else { None };
    }

    fn exchange_state(&self) -> ExchangeState {
        match (self.occupancy, self.state) {
            (Occupancy::Inside, _) => ExchangeState::Inside,
            (Occupancy::Committed, _) => ExchangeState::Committed,
            (_, SlotState::Held) => ExchangeState::Granted,
            (_, SlotState::Waiting | SlotState::Deadlock) => ExchangeState::Waiting,
            (_, SlotState::Away) => ExchangeState::Outside,
        }
    }

    /// The state with a shared arbiter. A slot that was granted may have been released in the same tick, because the
    /// robot yielded.
    fn shared_state(&self, arbiter: &ZoneArbiter, robot: RobotSlot) -> SlotState {
        match self.grant {
            None => SlotState::Away,
            Some(Grant::Held) if arbiter.holder(self.slot) == Some(robot) => SlotState::Held,
            Some(Grant::Held | Grant::Waiting(_) | Grant::Unknown(_)) => SlotState::Waiting,
            Some(Grant::Deadlock) => SlotState::Deadlock,
        }
    }

    /// The state with grants from outside. A grant that ends when the robot cannot stop outside any more counts as used:
    /// stopping the robot inside the region has no benefit. After a pause its controller has stopped it: outside it waits
    /// until the grant is confirmed.
    fn granted_state(&self, may_enter: bool, has_paused: bool) -> SlotState {
        let is_under_way = self.occupancy == Occupancy::Inside || self.occupancy == Occupancy::Committed && !has_paused;
        let goes_on = self.state == SlotState::Held && is_under_way;
        if may_enter || goes_on {
            SlotState::Held
        } else if self.is_near_active_region {
            SlotState::Waiting
        } else {
            SlotState::Away
        }
    }

    fn log_change(&self, to: SlotState, log: &mut EventLog) {
        for region in &self.regions {
            if self.state == SlotState::Held {
                log.push(Some(*region), EventKind::Released);
            }
            match to {
                SlotState::Held => log.push(Some(*region), EventKind::Granted),
                SlotState::Waiting => log.push(Some(*region), EventKind::Waiting),
                SlotState::Deadlock => log.push(Some(*region), EventKind::Deadlock),
                SlotState::Away => {}
            }
        }
    }
}
