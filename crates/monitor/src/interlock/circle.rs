//! Robots that wait for each other in a circle.

use super::{Board, Grant, Planted, RobotSlot, SlotId, Stay};

/// Robots, one bit each: circles are looked for among the first 128.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Robots(pub(super) u128);

impl Robots {
    pub(super) const MOST: usize = 128;

    pub(super) fn insert(&mut self, robot: RobotSlot) -> bool {
        let fresh = robot.0 < Self::MOST && !self.contains(robot);
        if fresh {
            self.0 |= 1 << robot.0;
        }
        fresh
    }

    pub(super) fn contains(self, robot: RobotSlot) -> bool {
        robot.0 < Self::MOST && self.0 >> robot.0 & 1 == 1
    }

    pub(super) fn iter(self) -> impl Iterator<Item = RobotSlot> {
        (0..Self::MOST).map(RobotSlot).filter(move |r| self.contains(*r))
    }
}

impl Board {
    /// The robots that wait for each other in a circle with this one, each with a slot that it waits for there; empty
    /// where it is in no circle. A robot whose whereabouts are unknown is in no circle: it may speak again, or be
    /// cleared. Not part of the tick: it allocates.
    pub fn circle(&self, robot: RobotSlot, now_s: f64) -> Vec<(RobotSlot, SlotId)> {
        let members = self.circle_of(robot, now_s);
        let slot =
            |r: RobotSlot| self.all_slots().find(|s| self.ticket(*s, r) > 0 && self.blocked_by(*s, r, now_s, members));
        members.iter().filter_map(|r| Some((r, slot(r)?))).collect()
    }

    pub(super) fn in_circle(&self, robot: RobotSlot, now_s: f64) -> bool {
        self.waits_for(robot, now_s).contains(robot)
    }

    /// True where every robot of the circle is inside something that it keeps others out of: nobody can yield.
    pub(super) fn circle_is_stuck(&self, robot: RobotSlot, now_s: f64) -> bool {
        self.circle_of(robot, now_s).iter().all(|r| self.all_slots().any(|s| self.stay(s, r) == Stay::Inside))
    }

    /// The way out of a circle of waiting robots: the first of them (by index) that holds something, and can stop
    /// outside of all that it holds, gives everything back. From then on the laws keep it out.
    pub(super) fn yield_held(&self, robot: RobotSlot, now_s: f64) {
        let can_yield = |r: &RobotSlot| {
            let mut held = self.all_slots().filter(|s| self.holder(*s) == Some(*r)).peekable();
            held.peek().is_some() && held.all(|s| !self.stay(s, *r).occupies() || self.has(Planted::YieldsCommitted))
        };
        if self.circle_of(robot, now_s).iter().find(can_yield) != Some(robot) {
            return;
        }
        for slot in self.all_slots().filter(|s| self.holder(*s) == Some(robot)) {
            self.give_back(slot, robot);
        }
    }

    /// This robot and those that wait for it and that it waits for.
    fn circle_of(&self, robot: RobotSlot, now_s: f64) -> Robots {
        let ahead = self.waits_for(robot, now_s);
        let mut members = Robots::default();
        for other in ahead.iter().filter(|o| ahead.contains(robot) && self.waits_for(*o, now_s).contains(robot)) {
            members.insert(other);
        }
        members
    }

    /// All robots that must move before this one can, directly or by way of others.
    fn waits_for(&self, robot: RobotSlot, now_s: f64) -> Robots {
        let mut found = Robots::default();
        self.add_blockers(robot, now_s, &mut found);
        let mut done = Robots::default();
        while let Some(next) = found.iter().find(|r| !done.contains(*r)) {
            done.insert(next);
            self.add_blockers(next, now_s, &mut found);
        }
        found
    }

    fn add_blockers(&self, robot: RobotSlot, now_s: f64, found: &mut Robots) {
        for slot in self.all_slots().filter(|s| self.ticket(*s, robot) > 0) {
            self.blockers(slot, robot, now_s).for_each(|b| {
                found.insert(b);
            });
        }
    }

    fn blocked_by(&self, slot: SlotId, robot: RobotSlot, now_s: f64, members: Robots) -> bool {
        self.blockers(slot, robot, now_s).any(|b| members.contains(b))
    }

    /// Who keeps `robot` out of the slot: its holder and whoever is in it, as far as that is known.
    fn blockers(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> impl Iterator<Item = RobotSlot> + '_ {
        let holder = self.holder(slot);
        self.others(slot, robot).filter(move |other| {
            let in_it = holder == Some(*other) || self.stay(slot, *other).occupies();
            in_it && !self.is_silent(slot, *other, now_s)
        })
    }
}

impl Grant {
    /// True for [`Grant::Held`].
    pub fn is_held(self) -> bool {
        self == Self::Held
    }
}
