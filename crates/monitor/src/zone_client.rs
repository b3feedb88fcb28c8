//! A monitor's client of the zone arbiter of the exchange regions.

use std::sync::Arc;

use crate::event::EventLog;
use crate::zone_state::ZoneState;
use crate::{Configuration, EventKind, Grant, Occupancy, RegionId, RegionKind, RobotSlot, SlotId, ZoneArbiter};

/// State of a robot with respect to an exchange region and those that share its slot (`docs/laws.md`, section 11).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExchangeState {
    /// Beyond the warning zone.
    Outside,
    /// In the warning zone, without the grant.
    Waiting,
    /// Granted, and able to stop outside.
    Granted,
    /// Not inside, but possibly unable to stop outside.
    Committed,
    /// Inside.
    Inside,
}

impl ExchangeState {
    /// The name in files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Waiting => "waiting",
            Self::Granted => "granted",
            Self::Committed => "committed",
            Self::Inside => "inside",
        }
    }
}

/// What a tick found at one region.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegionStatus {
    /// The region is active.
    pub(crate) active: bool,
    pub(crate) zone: ZoneState,
    /// The robot can stop outside the region.
    pub(crate) stops_outside: bool,
}

/// The client of one robot.
#[derive(Debug)]
pub(crate) struct ZoneClient {
    arbiter: Arc<ZoneArbiter>,
    robot: RobotSlot,
    slots: Vec<SlotSession>,
    /// True where the deceleration is stated, so that a moving robot can be proven to stop outside.
    proves_stops: bool,
}

/// One slot of the arbiter, as used by the robot.
#[derive(Debug)]
struct SlotSession {
    slot: SlotId,
    regions: Vec<RegionId>,
    occupancy: Occupancy,
    grant: Option<Grant>,
    state: SlotState,
    /// Time since which the robot holds the slot outside of all warning zones.
    left_s: Option<f64>,
}

/// A robot that has left but cannot be proven to stop outside keeps its slot. For this time (s) its override is not limited
/// by the slot's regions; afterwards it is, until the robot can stop. Most robots are far enough away by then.
const LEAVING_S: f64 = 0.25;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SlotState {
    Away,
    Held,
    Waiting,
    Deadlock,
}

impl ZoneClient {
    /// `None` where the arbiter does not have a slot or the robot.
    pub(crate) fn new(arbiter: Arc<ZoneArbiter>, robot: RobotSlot, config: &Configuration) -> Option<Self> {
        let mut slots: Vec<SlotSession> = Vec::new();
        for (r, region) in config.regions.iter().enumerate() {
            let RegionKind::Exchange { slot } = region.kind else { continue };
            if slot.0 >= arbiter.slots() || robot.0 >= arbiter.robots() {
                return None;
            }
            match slots.iter_mut().find(|u| u.slot == slot) {
                Some(known) => known.regions.push(RegionId(r)),
                None => slots.push(SlotSession::new(slot, RegionId(r))),
            }
            arbiter.register(slot, robot);
        }
        Some(Self { arbiter, robot, slots, proves_stops: config.laws.stopping_distance.is_some() })
    }

    /// Publishes the robot's occupancy and requests the slots that it is near. A tick with invalid input does not call this:
    /// the published occupancy and the held slots stay as they are.
    pub(crate) fn update(&mut self, status: impl Fn(RegionId) -> RegionStatus, now_s: f64, log: &mut EventLog) {
        for session in &mut self.slots {
            // Without a stated deceleration nothing is proven for a moving robot. Until the slot is granted, the warning law
            // is assumed to keep it outside.
            let held = session.state == SlotState::Held;
            let occupancy = |region: RegionStatus| {
                let can_stop = region.stops_outside || !(self.proves_stops || held && region.zone.warned);
                region.zone.occupancy(can_stop)
            };
            let active = || session.regions.iter().map(|r| status(*r)).filter(|region| region.active);
            let warned = active().any(|region| region.zone.warned);
            session.occupancy = active().map(occupancy).max().unwrap_or(Occupancy::Outside);
            session.left_s = if held && !warned { session.left_s.or(Some(now_s)) } else { None };
        }
        self.exchange(now_s);
        for session in &mut self.slots {
            let state = session.state_now(&self.arbiter, self.robot);
            if state != session.state {
                session.log_change(state, log);
                session.state = state;
            }
        }
    }

    /// Publishes the occupancy of all slots before the first request: other robots may be granted a slot, and this robot may
    /// have to yield, because of it.
    fn exchange(&mut self, now_s: f64) {
        for session in &self.slots {
            self.arbiter.publish(session.slot, self.robot, session.occupancy, now_s);
        }
        for session in &mut self.slots {
            let is_near = session.occupancy > Occupancy::Outside;
            session.grant = is_near.then(|| self.arbiter.request(session.slot, self.robot, now_s));
        }
    }

    /// Invalidates the published occupancy of a slot, because one of its regions was switched on.
    pub(crate) fn invalidate(&self, slot: SlotId) {
        self.arbiter.invalidate(slot, self.robot);
    }

    /// True where another robot holds the slot, or occupies it.
    pub(crate) fn is_taken(&self, slot: SlotId) -> bool {
        let others = || (0..self.arbiter.robots()).map(RobotSlot).filter(|r| *r != self.robot);
        match self.arbiter.holder(slot) {
            Some(holder) => holder != self.robot,
            None => others().any(|r| self.arbiter.occupancy(slot, r).occupies()),
        }
    }

    pub(crate) fn state(&self, slot: SlotId) -> ExchangeState {
        let Some(session) = self.slots.iter().find(|s| s.slot == slot) else { return ExchangeState::Outside };
        match (session.occupancy, session.state) {
            (Occupancy::Inside, _) => ExchangeState::Inside,
            (Occupancy::Committed, _) => ExchangeState::Committed,
            (_, SlotState::Held) => ExchangeState::Granted,
            (_, SlotState::Waiting | SlotState::Deadlock) => ExchangeState::Waiting,
            (_, SlotState::Away) => ExchangeState::Outside,
        }
    }

    pub(crate) fn holds(&self, slot: SlotId) -> bool {
        self.slots.iter().any(|s| s.slot == slot && s.state == SlotState::Held)
    }

    /// True where the slot's regions do not limit this robot: it holds the slot and has not left for longer than
    /// [`LEAVING_S`].
    pub(crate) fn may_enter(&self, slot: SlotId, now_s: f64) -> bool {
        let has_left = |s: &SlotSession| s.left_s.is_some_and(|left_s| now_s - left_s > LEAVING_S);
        self.slots.iter().any(|s| s.slot == slot && s.state == SlotState::Held && !has_left(s))
    }
}

impl SlotSession {
    fn new(slot: SlotId, region: RegionId) -> Self {
        let (occupancy, state) = (Occupancy::Unknown, SlotState::Away);
        Self { slot, regions: vec![region], occupancy, grant: None, state, left_s: None }
    }

    /// A slot that was granted may have been released in the same tick, by yielding.
    fn state_now(&self, arbiter: &ZoneArbiter, robot: RobotSlot) -> SlotState {
        match self.grant {
            None => SlotState::Away,
            Some(Grant::Held) if arbiter.holder(self.slot) == Some(robot) => SlotState::Held,
            Some(Grant::Held | Grant::Waiting(_) | Grant::Unknown(_)) => SlotState::Waiting,
            Some(Grant::Deadlock) => SlotState::Deadlock,
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
