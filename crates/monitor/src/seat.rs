//! A monitor's place on the board of exchange regions.

use std::sync::Arc;

use crate::events::EventLog;
use crate::interlock::Stay;
use crate::presence::Presence;
use crate::{Board, Configuration, EventKind, Grant, Kind, RegionId, RobotSlot, SlotId};

/// One robot's dealings with the board.
#[derive(Debug)]
pub(crate) struct Seat {
    board: Arc<Board>,
    robot: RobotSlot,
    slots: Vec<SlotUse>,
}

#[derive(Debug)]
struct SlotUse {
    slot: SlotId,
    regions: Vec<RegionId>,
    state: SlotState,
}

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
                None => slots.push(SlotUse { slot, regions: vec![RegionId(r)], state: SlotState::Away }),
            }
            board.expect(slot, robot);
        }
        Some(Self { board, robot, slots })
    }

    /// Publishes where the robot is and asks for the slots it is near. Nothing is published in a tick whose input is
    /// not trusted: the robot's place then stays what it was, and what it holds stays held.
    pub(crate) fn update(&mut self, active: &[bool], presence: &[Presence], now_s: f64, log: &mut EventLog) {
        for u in &mut self.slots {
            let live = u.regions.iter().filter(|r| active[r.0]);
            let stay = live.map(|r| presence[r.0].stay()).max().unwrap_or(Stay::Outside);
            self.board.publish(u.slot, self.robot, stay, now_s);
            let state = match stay {
                Stay::Outside | Stay::Unknown => SlotState::Away,
                Stay::Warning | Stay::Inside => match self.board.request(u.slot, self.robot, now_s) {
                    Grant::Held => SlotState::Held,
                    Grant::Waiting(_) | Grant::Unknown(_) => SlotState::Waiting,
                    Grant::Deadlock => SlotState::Deadlock,
                },
            };
            if state != u.state {
                u.log_change(state, log);
                u.state = state;
            }
        }
    }

    /// True where another robot holds the slot, or is in its regions.
    pub(crate) fn is_taken(&self, slot: SlotId) -> bool {
        let inside = |r: &RobotSlot| self.board.stay(slot, *r) == Stay::Inside;
        match self.board.holder(slot) {
            Some(holder) => holder != self.robot,
            None => (0..self.board.robots()).map(RobotSlot).filter(|r| *r != self.robot).any(|r| inside(&r)),
        }
    }

    pub(crate) fn holds(&self, slot: SlotId) -> bool {
        self.slots.iter().any(|u| u.slot == slot && u.state == SlotState::Held)
    }
}

impl SlotUse {
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
