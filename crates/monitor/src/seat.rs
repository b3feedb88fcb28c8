//! A monitor's place on the board of exchange regions.

use std::sync::Arc;

use crate::events::EventLog;
use crate::interlock::Stay;
use crate::presence::Presence;
use crate::{Board, Configuration, EventKind, Grant, Kind, RegionId, RobotSlot, SlotId};

/// How a robot stands to an exchange region and those that share its slot (`docs/laws.md`, section 11).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExchangeState {
    /// Beyond the warning zone.
    Outside,
    /// In the warning zone, without the grant.
    Waiting,
    /// It has the grant, and can still stop outside.
    Granted,
    /// Not inside, but it may not be able to stop outside any more.
    Committed,
    /// Inside.
    Inside,
}

impl ExchangeState {
    /// The word in files and messages.
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

/// One robot's dealings with the board.
#[derive(Debug)]
pub(crate) struct Seat {
    board: Arc<Board>,
    robot: RobotSlot,
    slots: Vec<SlotUse>,
    /// True where it can be proven that the robot stops outside while it moves: how it brakes is stated.
    proves_stops: bool,
}

#[derive(Debug)]
struct SlotUse {
    slot: SlotId,
    regions: Vec<RegionId>,
    stay: Stay,
    answer: Option<Grant>,
    state: SlotState,
    /// Since when the robot holds the slot outside of all warning zones.
    left_s: Option<f64>,
}

/// So long (s) a robot that has left keeps a slot, as it cannot be proven to stop outside, before it is slowed down like
/// any other robot, until it can. Most are far enough away by then.
const LEAVING_S: f64 = 0.25;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum SlotState {
    Away,
    Held,
    Waiting,
    Deadlock,
}

impl Seat {
    /// `None` where a slot or the robot is not on the board.
    pub(crate) fn new(board: Arc<Board>, robot: RobotSlot, config: &Configuration) -> Option<Self> {
        let mut slots: Vec<SlotUse> = Vec::new();
        for (r, region) in config.regions.iter().enumerate() {
            let Kind::Exchange { slot } = region.kind else { continue };
            if slot.0 >= board.slots() || robot.0 >= board.robots() {
                return None;
            }
            match slots.iter_mut().find(|u| u.slot == slot) {
                Some(known) => known.regions.push(RegionId(r)),
                None => slots.push(SlotUse::new(slot, RegionId(r))),
            }
            board.expect(slot, robot);
        }
        Some(Self { board, robot, slots, proves_stops: config.laws.stopping_distance.is_some() })
    }

    /// Publishes where the robot is and asks for the slots it is near; `at` says of a region whether it is active, where
    /// the robot is, and whether it can stop outside. Nothing is published in a tick whose input is not trusted: the
    /// robot's place then stays what it was, and what it holds stays held.
    pub(crate) fn update(&mut self, at: impl Fn(RegionId) -> (bool, Presence, bool), now_s: f64, log: &mut EventLog) {
        for u in &mut self.slots {
            // Without a stated deceleration nothing is proven for a robot that moves. It is then taken to be kept out by
            // the warning law, until it is let in.
            let held = u.state == SlotState::Held;
            let stay = |(_, presence, stops): (bool, Presence, bool)| {
                let stops = stops || !(self.proves_stops || held && presence.warned);
                presence.stay(stops)
            };
            let active = u.regions.iter().map(|r| at(*r)).filter(|a| a.0);
            u.stay = active.map(stay).max().unwrap_or(Stay::Outside);
            let warned = u.regions.iter().map(|r| at(*r)).any(|(active, presence, _)| active && presence.warned);
            u.left_s = if held && !warned { u.left_s.or(Some(now_s)) } else { None };
        }
        self.exchange(now_s);
        for u in &mut self.slots {
            let state = u.state_now(&self.board, self.robot);
            if state != u.state {
                u.log_change(state, log);
                u.state = state;
            }
        }
    }

    /// Where the robot is goes to the board for all slots before it asks for the first: others may be granted, and the
    /// robot may be asked to yield, by what it said.
    fn exchange(&mut self, now_s: f64) {
        for u in &self.slots {
            self.board.publish(u.slot, self.robot, u.stay, now_s);
        }
        for u in &mut self.slots {
            let near = u.stay > Stay::Outside;
            u.answer = near.then(|| self.board.request(u.slot, self.robot, now_s));
        }
    }

    /// One of the slot's regions was switched on: what the robot said without it counts no more.
    pub(crate) fn forget(&self, slot: SlotId) {
        self.board.forget(slot, self.robot);
    }

    /// True where another robot holds the slot, or occupies it.
    pub(crate) fn is_taken(&self, slot: SlotId) -> bool {
        let others = || (0..self.board.robots()).map(RobotSlot).filter(|r| *r != self.robot);
        match self.board.holder(slot) {
            Some(holder) => holder != self.robot,
            None => others().any(|r| self.board.stay(slot, r).occupies()),
        }
    }

    pub(crate) fn state(&self, slot: SlotId) -> ExchangeState {
        let Some(u) = self.slots.iter().find(|u| u.slot == slot) else { return ExchangeState::Outside };
        match (u.stay, u.state) {
            (Stay::Inside, _) => ExchangeState::Inside,
            (Stay::Committed, _) => ExchangeState::Committed,
            (_, SlotState::Held) => ExchangeState::Granted,
            (_, SlotState::Waiting | SlotState::Deadlock) => ExchangeState::Waiting,
            (_, SlotState::Away) => ExchangeState::Outside,
        }
    }

    pub(crate) fn holds(&self, slot: SlotId) -> bool {
        self.slots.iter().any(|u| u.slot == slot && u.state == SlotState::Held)
    }

    /// True where the slot's regions do not count for this robot: it holds them, and did not leave long ago.
    pub(crate) fn may_enter(&self, slot: SlotId, now_s: f64) -> bool {
        let long_gone = |u: &SlotUse| u.left_s.is_some_and(|left_s| now_s - left_s > LEAVING_S);
        self.slots.iter().any(|u| u.slot == slot && u.state == SlotState::Held && !long_gone(u))
    }
}

impl SlotUse {
    fn new(slot: SlotId, region: RegionId) -> Self {
        Self { slot, regions: vec![region], stay: Stay::Unknown, answer: None, state: SlotState::Away, left_s: None }
    }

    /// A slot that was granted may have been given back in the same tick, by yielding.
    fn state_now(&self, board: &Board, robot: RobotSlot) -> SlotState {
        match self.answer {
            None => SlotState::Away,
            Some(Grant::Held) if board.holder(self.slot) == Some(robot) => SlotState::Held,
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
