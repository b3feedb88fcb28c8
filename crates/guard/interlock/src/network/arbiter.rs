//! The arbiter: grants slots to robots.

#[cfg(test)]
mod model_access;

use super::slot_record::{Holder, SlotRecord, wait_for_graph};
use crate::{
    ArbiterEvent, ArbiterSettings, Boot, GrantsMessage, Micros, Occupancy, RobotSet, RobotSlot, SlotAnswer, SlotId,
    SlotReport, StateMessage, Token,
};

/// The outputs of a step of the arbiter.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Outputs {
    /// Messages to guards.
    pub replies: Vec<GrantsMessage>,
    /// Changes at the arbiter.
    pub events: Vec<ArbiterEvent>,
}

/// The arbiter of a cell. It never takes a slot back: the holder releases it, or the integrator clears a silent holder.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Arbiter {
    settings: ArbiterSettings,
    boot: Boot,
    started: Option<Micros>,
    serial: u64,
    tokens: u64,
    robots: Vec<RobotRecord>,
    slots: Vec<SlotRecord>,
    /// The deadlocks that were reported and still exist.
    deadlocks: Vec<Vec<RobotSlot>>,
}

/// The arbiter's knowledge of a robot.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct RobotRecord {
    boot: Boot,
    sequence: u64,
    heard: Option<Micros>,
    /// True if the last message had this configuration and its guard obeys this start of the arbiter.
    is_trusted: bool,
    /// True if the integrator declared the robot to be outside, and it has been silent since.
    is_cleared: bool,
    reports: Vec<SlotReport>,
}

impl RobotRecord {
    fn new(slots: usize) -> Self {
        Self {
            boot: Boot::NONE,
            sequence: 0,
            heard: None,
            is_trusted: false,
            is_cleared: false,
            reports: vec![SlotReport::UNKNOWN; slots],
        }
    }

    /// The reported occupancy of a slot; `Unknown` if the robot is not trusted.
    fn occupancy(&self, slot: SlotId) -> Occupancy {
        if self.is_trusted { self.reports[slot.0].occupancy } else { Occupancy::Unknown }
    }
}

impl Arbiter {
    /// An arbiter without knowledge of its robots. `boot` should be higher than for all former arbiters. The time of
    /// day is sufficient: an arbiter that learns of a higher number before it is in service takes the next number.
    pub fn new(settings: ArbiterSettings, boot: Boot) -> Self {
        let robots = vec![RobotRecord::new(settings.slots); settings.robots.len()];
        let slots = vec![SlotRecord::default(); settings.slots];
        Self { settings, boot, started: None, serial: 0, tokens: 0, robots, slots, deadlocks: Vec::new() }
    }

    /// Start of this arbiter.
    pub fn boot(&self) -> Boot {
        self.boot
    }

    /// The robot that holds a slot.
    pub fn holder(&self, slot: SlotId) -> Option<RobotSlot> {
        self.slots[slot.0].holder.map(|holder| holder.robot)
    }

    /// The robots that wait for a slot, in the order of their requests.
    pub fn queue(&self, slot: SlotId) -> &[RobotSlot] {
        &self.slots[slot.0].queue
    }

    /// True if a robot's last message can be trusted and is not older than the silence of the settings.
    pub fn is_known(&self, robot: RobotSlot, now: Micros) -> bool {
        let record = &self.robots[robot.0];
        record.is_trusted && record.heard.is_some_and(|heard| now - heard <= self.settings.silence)
    }

    /// Processes a message of a guard. It changes nothing if it is late or repeated, or its robot is not in the cell.
    pub fn receive(&mut self, message: &StateMessage, now: Micros) -> Outputs {
        let mut outputs = Outputs::default();
        self.started.get_or_insert(now);
        let robot = message.robot;
        if robot.0 >= self.robots.len() || message.slots.len() != self.slots.len() {
            return outputs;
        }
        if message.arbiter > self.boot {
            self.take_next_boot(message.arbiter, now, &mut outputs);
        }
        if message.boot < self.robots[robot.0].boot {
            outputs.replies.push(self.answer(robot));
            return outputs;
        }
        if message.boot > self.robots[robot.0].boot {
            if self.may_obey_a_grant(robot, now) {
                return outputs;
            }
            self.start_guard(robot, message.boot, &mut outputs);
        }
        if message.sequence <= self.robots[robot.0].sequence {
            return outputs;
        }
        self.record(message, now, &mut outputs);
        if self.robots[robot.0].is_trusted {
            self.settle(robot, &mut outputs);
        }
        let granted = self.grant_free_slots(now, &mut outputs);
        self.resolve_cycles(now, &mut outputs);
        outputs.replies.push(self.answer(robot));
        for other in granted.into_iter().filter(|other| *other != robot) {
            let answer = self.answer(other);
            outputs.replies.push(answer);
        }
        outputs
    }

    /// Checks that a robot has been silent for so long that its last grant has expired and it has come to rest.
    ///
    /// # Errors
    /// The time for which the robot must still be silent.
    pub fn may_clear(&mut self, robot: RobotSlot, now: Micros) -> Result<(), Micros> {
        let settings = &self.settings.robots[robot.0];
        let needed = (self.settings.validity + settings.stop_time).with_drift();
        let since = self.robots[robot.0].heard.or(self.started);
        let silent = since.map_or(Micros(0), |since| now - since);
        self.started.get_or_insert(now);
        if silent < needed { Err(needed - silent) } else { Ok(()) }
    }

    /// Declares that a silent robot is at rest outside all regions, as seen by the integrator. Its slots become free,
    /// and other robots are granted slots without it until it sends a message again. No other arbiter of the cell may run
    /// then: it could still confirm a grant of this robot.
    ///
    /// # Errors
    /// The time for which the robot must still be silent.
    pub fn clear(&mut self, robot: RobotSlot, now: Micros) -> Result<Outputs, Micros> {
        self.may_clear(robot, now)?;
        Ok(self.clear_at_once(robot, now))
    }

    /// Like [`Arbiter::clear`], without the check that makes it safe.
    pub(crate) fn clear_at_once(&mut self, robot: RobotSlot, now: Micros) -> Outputs {
        let mut outputs = Outputs::default();
        let record = &mut self.robots[robot.0];
        (record.is_cleared, record.is_trusted) = (true, false);
        record.reports.fill(SlotReport::UNKNOWN);
        outputs.events.push(ArbiterEvent::Cleared(robot));
        for s in 0..self.slots.len() {
            self.slots[s].queue.retain(|other| *other != robot);
            self.slots[s].intruders.retain(|other| *other != robot);
            if self.slots[s].is_held_by(robot) {
                self.free(SlotId(s));
            }
        }
        for other in self.grant_free_slots(now, &mut outputs) {
            let answer = self.answer(other);
            outputs.replies.push(answer);
        }
        outputs
    }

    /// Restarts with the next number and without knowledge, because a guard obeys a later start of an arbiter.
    fn take_next_boot(&mut self, other: Boot, now: Micros, outputs: &mut Outputs) {
        *self = Self { started: Some(now), ..Self::new(self.settings.clone(), other.next()) };
        outputs.events.push(ArbiterEvent::StartedAgain(self.boot));
    }

    /// Whether the guard of the last message may still obey a grant. While it may, messages of a second guard of the
    /// robot are ignored, so that the second guard never reports about a time before the last use of a grant.
    fn may_obey_a_grant(&self, robot: RobotSlot, now: Micros) -> bool {
        let longest = self.settings.validity.with_drift();
        self.robots[robot.0].heard.is_some_and(|heard| now - heard <= longest)
    }

    /// Records a guard's start: its slots are neither confirmed nor granted to others until it reports its occupancy.
    fn start_guard(&mut self, robot: RobotSlot, boot: Boot, outputs: &mut Outputs) {
        let is_first = self.robots[robot.0].boot == Boot::NONE;
        self.robots[robot.0] = RobotRecord { boot, ..RobotRecord::new(self.slots.len()) };
        for slot in &mut self.slots {
            slot.queue.retain(|other| *other != robot);
            if let Some(holder) = slot.holder.as_mut().filter(|holder| holder.robot == robot) {
                holder.token = None;
            }
        }
        if !is_first {
            outputs.events.push(ArbiterEvent::GuardStarted(robot, boot));
        }
    }

    fn record(&mut self, message: &StateMessage, now: Micros, outputs: &mut Outputs) {
        let same_configuration = message.checksum == self.settings.checksum;
        let record = &mut self.robots[message.robot.0];
        if !same_configuration && (record.is_trusted || record.heard.is_none()) {
            outputs.events.push(ArbiterEvent::OtherConfiguration(message.robot));
        }
        record.sequence = message.sequence;
        record.heard = Some(now);
        record.is_cleared = false;
        record.is_trusted = same_configuration && message.arbiter == self.boot;
        record.reports.clone_from(&message.slots);
    }

    /// Applies a robot's report: frees the slots that it gave up, and makes it hold the slots that it was found in.
    fn settle(&mut self, robot: RobotSlot, outputs: &mut Outputs) {
        for slot in self.settings.robots[robot.0].slots.clone() {
            let report = self.robots[robot.0].reports[slot.0];
            if self.slots[slot.0].is_held_by(robot) && self.gives_up(slot, robot, report) {
                self.free(slot);
                outputs.events.push(ArbiterEvent::Released(slot, robot));
            }
            let waits = report.wants && !self.slots[slot.0].is_held_by(robot);
            let queue = &mut self.slots[slot.0].queue;
            match (waits, queue.contains(&robot)) {
                (true, false) => queue.push(robot),
                (false, true) => queue.retain(|other| *other != robot),
                _ => {}
            }
            match report.occupancy {
                // It is not inside yet: if nobody holds the slot, nobody else gets it, and this robot only when all others are
                // known to be outside.
                Occupancy::Committed if self.slots[slot.0].holder.is_none() => self.keep_for(slot, robot),
                Occupancy::Committed if self.slots[slot.0].is_held_by(robot) => {}
                Occupancy::Committed | Occupancy::Inside => self.found_inside(slot, robot, outputs),
                Occupancy::Outside | Occupancy::Warning => self.slots[slot.0].intruders.retain(|r| *r != robot),
                Occupancy::Unknown => {}
            }
        }
    }

    /// Whether the holder's report gives up its slot.
    fn gives_up(&self, slot: SlotId, robot: RobotSlot, report: SlotReport) -> bool {
        match self.slots[slot.0].token_of(robot) {
            Some(token) => report.released >= Some(token),
            // The guard started again: the grant was for the former guard.
            None => matches!(report.occupancy, Occupancy::Outside | Occupancy::Warning),
        }
    }

    /// Makes a robot that may be inside the holder of the slot, if no other robot holds it.
    fn found_inside(&mut self, slot: SlotId, robot: RobotSlot, outputs: &mut Outputs) {
        match self.slots[slot.0].holder {
            None => {
                self.hold(slot, robot);
                outputs.events.push(ArbiterEvent::FoundInside(slot, robot));
            }
            Some(holder) if holder.robot == robot => {
                if holder.token.is_none() {
                    self.hold(slot, robot);
                }
            }
            Some(holder) if !self.slots[slot.0].intruders.contains(&robot) => {
                self.slots[slot.0].intruders.push(robot);
                outputs.events.push(ArbiterEvent::Conflict(slot, holder.robot, robot));
            }
            Some(_) => {}
        }
    }

    /// Makes a robot hold the slot without the right to enter.
    fn keep_for(&mut self, slot: SlotId, robot: RobotSlot) {
        let record = &mut self.slots[slot.0];
        record.holder = Some(Holder { robot, token: None });
        record.intruders.retain(|other| *other != robot);
    }

    /// The robot that holds the slot without the right to enter, if it can no longer stop outside.
    fn committed_without_token(&self, slot: SlotId) -> Option<RobotSlot> {
        let holder = self.slots[slot.0].holder.filter(|holder| holder.token.is_none())?;
        let is_committed = self.robots[holder.robot.0].occupancy(slot) == Occupancy::Committed;
        is_committed.then_some(holder.robot)
    }

    fn free(&mut self, slot: SlotId) {
        let slot = &mut self.slots[slot.0];
        (slot.holder, slot.release_requested) = (None, false);
    }

    fn hold(&mut self, slot: SlotId, robot: RobotSlot) {
        self.tokens += 1;
        let token = Some(Token { boot: self.boot, number: self.tokens });
        let record = &mut self.slots[slot.0];
        record.holder = Some(Holder { robot, token });
        record.queue.retain(|other| *other != robot);
        record.intruders.retain(|other| *other != robot);
    }

    /// Grants each free slot to its first waiting robot, and each slot that is kept for a committed robot to that robot, if
    /// all others are known to be outside. Returns these robots.
    fn grant_free_slots(&mut self, now: Micros, outputs: &mut Outputs) -> Vec<RobotSlot> {
        let mut granted = Vec::new();
        for slot in (0..self.slots.len()).map(SlotId) {
            let next = match self.slots[slot.0].holder {
                Some(_) => self.committed_without_token(slot),
                None => self.first_waiting(slot),
            };
            let Some(robot) = next.filter(|robot| self.may_grant(slot, *robot, now)) else { continue };
            self.hold(slot, robot);
            outputs.events.push(ArbiterEvent::Granted(slot, robot));
            granted.push(robot);
        }
        granted
    }

    /// The waiting robot with the highest priority; among equals, the robot that has waited longest. A robot that would
    /// close a cycle with the slot is skipped until another robot of the queue has had it: otherwise a release that
    /// resolves a cycle would close it again.
    fn first_waiting(&self, slot: SlotId) -> Option<RobotSlot> {
        let slot = &self.slots[slot.0];
        let graph = wait_for_graph(&self.slots);
        let able = slot.queue.iter().enumerate().filter(|(_, robot)| !slot.would_close_cycle(&graph, **robot));
        let rank =
            |(place, robot): &(usize, &RobotSlot)| (std::cmp::Reverse(self.settings.robots[robot.0].priority), *place);
        able.min_by_key(rank).map(|(_, robot)| *robot)
    }

    /// Whether the slot may be granted: the robot itself is known, and every other robot that can ever be in it is known
    /// to be outside without a grant, or was cleared.
    fn may_grant(&self, slot: SlotId, robot: RobotSlot, now: Micros) -> bool {
        let others = (0..self.robots.len()).map(RobotSlot).filter(|other| *other != robot);
        let mut expected = others.filter(|other| self.settings.robots[other.0].slots.contains(&slot));
        self.is_known(robot, now)
            && expected.all(|other| {
                let record = &self.robots[other.0];
                let is_outside = matches!(record.occupancy(slot), Occupancy::Outside | Occupancy::Warning);
                record.is_cleared || self.is_known(other, now) && is_outside && record.reports[slot.0].token.is_none()
            })
    }

    /// Asks a robot of each cycle to give up a slot that another robot of it waits for, or reports the deadlock.
    fn resolve_cycles(&mut self, now: Micros, outputs: &mut Outputs) {
        for slot in &mut self.slots {
            slot.release_requested = false;
        }
        let mut deadlocks = Vec::new();
        for cycle in wait_for_graph(&self.slots).cycles() {
            match self.least_important(cycle, now) {
                Some(slot) => self.slots[slot.0].release_requested = true,
                None => deadlocks.push(cycle.iter().collect()),
            }
        }
        let unreported = deadlocks.iter().filter(|cycle| !self.deadlocks.contains(cycle));
        outputs.events.extend(unreported.cloned().map(ArbiterEvent::Deadlock));
        self.deadlocks = deadlocks;
    }

    /// The slot to give up in a cycle: its holder in the cycle can give it up, and another robot of the cycle waits for
    /// it. Chooses the holder with the lowest priority; among equals, the slot that was granted last.
    fn least_important(&self, cycle: RobotSet, now: Micros) -> Option<SlotId> {
        let holder = |slot: SlotId| self.slots[slot.0].holder.map(|h| h.robot).filter(|robot| cycle.contains(*robot));
        let is_waited_for = |slot: SlotId| self.slots[slot.0].queue.iter().any(|robot| cycle.contains(*robot));
        let held = (0..self.slots.len()).map(SlotId).filter_map(|slot| Some((slot, holder(slot)?)));
        let able = held.filter(|(slot, robot)| is_waited_for(*slot) && self.can_give_up(*slot, *robot, now));
        let rank = |(slot, robot): &(SlotId, RobotSlot)| {
            (self.settings.robots[robot.0].priority, std::cmp::Reverse(self.slots[slot.0].token_of(*robot)))
        };
        able.min_by_key(rank).map(|(slot, _)| slot)
    }

    fn can_give_up(&self, slot: SlotId, robot: RobotSlot, now: Micros) -> bool {
        let occupancy = self.robots[robot.0].occupancy(slot);
        self.is_known(robot, now) && matches!(occupancy, Occupancy::Outside | Occupancy::Warning)
    }

    /// The next message to a guard.
    fn answer(&mut self, robot: RobotSlot) -> GrantsMessage {
        self.serial += 1;
        let record = &self.robots[robot.0];
        let answer = |(index, slot): (usize, &SlotRecord)| {
            let is_held = record.is_trusted && slot.is_held_by(robot);
            SlotAnswer {
                granted: slot.token_of(robot).filter(|_| is_held),
                release_requested: is_held && slot.release_requested,
                halt: self.must_halt(SlotId(index), robot),
            }
        };
        GrantsMessage {
            checksum: self.settings.checksum,
            arbiter: self.boot,
            serial: self.serial,
            robot,
            robot_boot: record.boot,
            echo: record.sequence,
            slots: self.slots.iter().enumerate().map(answer).collect(),
        }
    }

    /// Whether the slot has intruders and this robot is its holder or one of them.
    fn must_halt(&self, slot: SlotId, robot: RobotSlot) -> bool {
        let slot = &self.slots[slot.0];
        !slot.intruders.is_empty() && (slot.is_held_by(robot) || slot.intruders.contains(&robot))
    }
}
