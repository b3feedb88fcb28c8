//! Access for the model check, which reads and rewrites the state.

use super::*;

impl Arbiter {
    pub(crate) fn each_time(&mut self, f: &mut impl FnMut(&mut Micros)) {
        self.started.iter_mut().for_each(&mut *f);
        self.robots.iter_mut().filter_map(|robot| robot.heard.as_mut()).for_each(f);
    }

    /// Forgets state that no later step reads: the reported deadlocks, all reports that cannot be trusted, and of the
    /// other reports everything but whether the robot occupies the slot and obeys a grant.
    pub(crate) fn forget_unread(&mut self) {
        let any = Some(Token { boot: Boot(1), number: 1 });
        self.deadlocks.clear();
        if self.robots.iter().all(|robot| robot.heard.is_some()) {
            self.started = None;
        }
        for robot in &mut self.robots {
            let is_trusted = robot.is_trusted;
            for report in &mut robot.reports {
                let occupancy = super::super::model::renaming::what_counts(report.occupancy);
                let seen = SlotReport { occupancy, token: report.token.and(any), ..SlotReport::UNKNOWN };
                *report = if is_trusted { seen } else { SlotReport::UNKNOWN };
            }
        }
    }

    pub(crate) fn holder_token_mut(&mut self, slot: SlotId) -> Option<(RobotSlot, &mut Token)> {
        let holder = self.slots[slot.0].holder.as_mut()?;
        Some((holder.robot, holder.token.as_mut()?))
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

    /// Gives robot `r` the index `to[r]`.
    pub(crate) fn reindex(&mut self, to: &[usize]) {
        super::super::model::renaming::permute(&mut self.robots, to);
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
