//! Access for the model check, which reads and rewrites the state.

use super::*;

impl Arbiter {
    pub(crate) fn each_time(&mut self, f: &mut impl FnMut(&mut Micros)) {
        self.started.iter_mut().for_each(&mut *f);
        self.robots.iter_mut().filter_map(|robot| robot.heard.as_mut()).for_each(f);
    }

    /// Forgets state that no later step reads: the reported deadlocks, all reports that cannot be trusted, and of the
    /// other reports everything but whether the robot occupies the slot and obeys a grant, and whether it is committed while
    /// the slot is kept for it.
    pub(crate) fn forget_unread(&mut self) {
        let any = Some(Token { boot: Boot(1), number: 1 });
        self.deadlocks.clear();
        if self.robots.iter().all(|robot| robot.heard.is_some()) {
            self.started = None;
        }
        for (r, robot) in self.robots.iter_mut().enumerate() {
            let is_trusted = robot.is_trusted;
            for (report, slot) in robot.reports.iter_mut().zip(&self.slots) {
                let is_kept = slot.holder.is_some_and(|h| h.robot.0 == r && h.token.is_none());
                let occupancy = match super::super::model::renaming::what_counts(report.occupancy) {
                    Occupancy::Committed if !is_kept => Occupancy::Inside,
                    occupancy => occupancy,
                };
                let seen = SlotReport { occupancy, token: report.token.and(any), ..SlotReport::UNKNOWN };
                *report = if is_trusted { seen } else { SlotReport::UNKNOWN };
            }
        }
    }

    /// Whether a robot holds a slot without the right to enter.
    pub(crate) fn is_kept(&self, slot: SlotId) -> bool {
        self.slots[slot.0].holder.is_some_and(|holder| holder.token.is_none())
    }

    pub(crate) fn holder_token_mut(&mut self, slot: SlotId) -> Option<(RobotSlot, &mut Token)> {
        let holder = self.slots[slot.0].holder.as_mut()?;
        Some((holder.robot, holder.token.as_mut()?))
    }

    /// This arbiter's knowledge of some robots and one slot, with other settings. All other robots become one, which is
    /// the last one.
    pub(crate) fn project(&self, robots: &[RobotSlot], slot: SlotId, settings: ArbiterSettings) -> Self {
        let mut projected = Self { started: self.started, serial: self.serial, ..Self::new(settings, self.boot) };
        projected.tokens = self.tokens;
        for (record, robot) in projected.robots.iter_mut().zip(robots) {
            *record = self.robots[robot.0].clone();
            record.reports = vec![record.reports[slot.0]];
        }
        let index = |robot: RobotSlot| robots.iter().position(|r| *r == robot).unwrap_or(robots.len());
        let holder = |holder: Holder| Holder { robot: RobotSlot(index(holder.robot)), ..holder };
        projected.slots = vec![SlotRecord { holder: self.slots[slot.0].holder.map(holder), ..SlotRecord::default() }];
        projected
    }

    /// Answers a robot without a message of it.
    pub(crate) fn answer_again(&mut self, robot: RobotSlot) -> GrantsMessage {
        self.answer(robot)
    }

    /// Reads or writes the fields that steps change.
    pub(crate) fn code(&mut self, codec: &mut super::super::model::codec::Codec) {
        codec.boot(&mut self.boot);
        codec.option(&mut self.started, Micros(0), super::super::model::codec::Codec::time);
        codec.number(&mut self.serial);
        codec.number(&mut self.tokens);
        for robot in &mut self.robots {
            codec.boot(&mut robot.boot);
            codec.number(&mut robot.sequence);
            codec.option(&mut robot.heard, Micros(0), super::super::model::codec::Codec::time);
            codec.flag(&mut robot.is_trusted);
            codec.flag(&mut robot.is_cleared);
            robot.reports.iter_mut().for_each(|report| codec.report(report));
        }
        for slot in &mut self.slots {
            codec.option(&mut slot.holder, Holder { robot: RobotSlot(0), token: None }, |codec, holder| {
                codec.index(&mut holder.robot.0);
                codec.token(&mut holder.token);
            });
            codec.robots(&mut slot.queue);
            codec.robots(&mut slot.intruders);
            codec.flag(&mut slot.release_requested);
        }
        self.deadlocks.clear();
    }

    pub(crate) fn boot_mut(&mut self) -> &mut Boot {
        &mut self.boot
    }

    pub(crate) fn guard_boot_mut(&mut self, robot: RobotSlot) -> &mut Boot {
        &mut self.robots[robot.0].boot
    }

    /// Makes this robot the only one that waits, for every slot.
    pub(crate) fn set_waiting(&mut self, waiting: Option<RobotSlot>) {
        self.slots.iter_mut().for_each(|slot| slot.queue = waiting.into_iter().collect());
    }

    /// Makes a robot known to be outside without a grant, or unknown. The next message of start 1 is not late.
    pub(crate) fn set_known(&mut self, robot: RobotSlot, is_known: bool, now: Micros) {
        let slots = self.slots.len();
        let report = SlotReport { occupancy: Occupancy::Outside, ..SlotReport::UNKNOWN };
        let reports = vec![if is_known { report } else { SlotReport::UNKNOWN }; slots];
        let (boot, heard) = (Boot(1), Some(now));
        self.robots[robot.0] = RobotRecord { boot, heard, is_trusted: is_known, reports, ..RobotRecord::new(slots) };
    }

    /// Forgets which grants a robot holds, but not that it holds slots; and for all robots, what waits and what halts.
    pub(crate) fn forget_grants_and_orders(&mut self, robot: RobotSlot) {
        for slot in &mut self.slots {
            slot.holder.iter_mut().filter(|holder| holder.robot == robot).for_each(|holder| holder.token = None);
            slot.queue.clear();
            slot.intruders.clear();
            slot.release_requested = false;
        }
    }

    pub(crate) fn sequence_mut(&mut self, robot: RobotSlot) -> &mut u64 {
        &mut self.robots[robot.0].sequence
    }

    /// Sets the counters of messages and grants to values above all that were given.
    pub(crate) fn set_counters(&mut self, serial: u64, tokens: u64) {
        (self.serial, self.tokens) = (serial, tokens);
    }

    /// Whether a message would change nothing while this arbiter runs.
    pub(crate) fn is_past(&self, message: &StateMessage) -> bool {
        let record = &self.robots[message.robot.0];
        message.arbiter <= self.boot && message.boot == record.boot && message.sequence <= record.sequence
    }

    /// Gives robot `r` the index `to[r]`. Later robots keep their index.
    pub(crate) fn reindex(&mut self, to: &[usize]) {
        let to: Vec<usize> = to.iter().copied().chain(to.len()..self.robots.len()).collect();
        super::super::model::renaming::permute(&mut self.robots, &to);
        let map = |robot: &mut RobotSlot| *robot = RobotSlot(to[robot.0]);
        for slot in &mut self.slots {
            slot.holder.iter_mut().for_each(|holder| map(&mut holder.robot));
            slot.queue.iter_mut().chain(&mut slot.intruders).for_each(map);
        }
    }

    /// Hashes everything about a robot except its index.
    pub(crate) fn hash_robot(&self, robot: RobotSlot, hasher: &mut impl std::hash::Hasher) {
        use std::hash::Hash;
        self.robots[robot.0].hash(hasher);
        for slot in &self.slots {
            let place = |robots: &[RobotSlot]| robots.iter().position(|other| *other == robot);
            (slot.is_held_by(robot), place(&slot.queue), place(&slot.intruders)).hash(hasher);
        }
    }

    /// A planted fault for the model check: takes a slot back.
    pub(crate) fn take_back(&mut self, slot: SlotId) {
        self.free(slot);
    }
}
