//! Deadlock detection: cycles of robots that wait for each other.

use super::occupancy::Occupancy;
use super::robot_set::RobotSet;
use super::shared_state::{InjectedFault, SharedState};
use super::slot::{RobotSlot, SlotId};

/// The wait-for graph of the first 128 robots at one instant. A robot waits for those that hold or occupy a slot that it has
/// requested. Silent robots are in no cycle: they may publish again, or be cleared.
pub(super) struct WaitForGraph<'a> {
    pub(super) state: &'a SharedState,
    pub(super) now_s: f64,
}

impl WaitForGraph<'_> {
    /// The robots in a cycle with this one, each with a slot that it waits for; empty where it is in no cycle.
    pub(super) fn cycle(&self, robot: RobotSlot) -> Vec<(RobotSlot, SlotId)> {
        let members = self.members(robot);
        let is_awaited = |s: &SlotId, r: RobotSlot| {
            self.state.ticket(*s, r) > 0 && self.blockers(*s, r).any(|b| members.contains(b))
        };
        let slot = |r: RobotSlot| self.state.all_slots().find(|s| is_awaited(s, r));
        members.iter().filter_map(|r| Some((r, slot(r)?))).collect()
    }

    /// True where the robot is in a cycle.
    pub(super) fn has_cycle(&self, robot: RobotSlot) -> bool {
        self.waits_for(robot).contains(robot)
    }

    /// True where every robot of the cycle is inside a region of some slot, so that none can yield.
    pub(super) fn is_stuck(&self, robot: RobotSlot) -> bool {
        let is_inside = |r| self.state.all_slots().any(|s| self.state.occupancy(s, r) == Occupancy::Inside);
        self.members(robot).iter().all(is_inside)
    }

    /// The robot that yields in the cycle: the first (by index) that holds a slot and can stop outside of all that it holds.
    pub(super) fn yielding_robot(&self, robot: RobotSlot) -> Option<RobotSlot> {
        let state = self.state;
        let can_yield = |r: &RobotSlot| {
            let mut held = state.all_slots().filter(|s| state.holder(*s) == Some(*r)).peekable();
            let may_release = |s| !state.occupancy(s, *r).occupies() || state.has(InjectedFault::YieldsCommitted);
            held.peek().is_some() && held.all(may_release)
        };
        self.members(robot).iter().find(can_yield)
    }

    /// The strongly connected component of the robot: those that wait for it and that it waits for.
    fn members(&self, robot: RobotSlot) -> RobotSet {
        let ahead = self.waits_for(robot);
        let mut members = RobotSet::default();
        for other in ahead.iter().filter(|o| ahead.contains(robot) && self.waits_for(*o).contains(robot)) {
            members.insert(other);
        }
        members
    }

    /// All robots that this one waits for, directly or through others.
    fn waits_for(&self, robot: RobotSlot) -> RobotSet {
        let mut found = RobotSet::default();
        self.add_blockers(robot, &mut found);
        let mut done = RobotSet::default();
        while let Some(next) = found.iter().find(|r| !done.contains(*r)) {
            done.insert(next);
            self.add_blockers(next, &mut found);
        }
        found
    }

    fn add_blockers(&self, robot: RobotSlot, found: &mut RobotSet) {
        for slot in self.state.all_slots().filter(|s| self.state.ticket(*s, robot) > 0) {
            self.blockers(slot, robot).for_each(|b| found.insert(b));
        }
    }

    /// The robots that block the slot for `robot`: its holder and those that occupy it, unless they are silent.
    fn blockers(&self, slot: SlotId, robot: RobotSlot) -> impl Iterator<Item = RobotSlot> + '_ {
        let holder = self.state.holder(slot);
        self.state.others(slot, robot).filter(move |other| {
            let blocks = holder == Some(*other) || self.state.occupancy(slot, *other).occupies();
            blocks && !self.state.is_silent(slot, *other, self.now_s)
        })
    }
}
