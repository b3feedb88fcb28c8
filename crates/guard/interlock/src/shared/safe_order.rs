//! Deadlock avoidance: a safe-state test over declared needs, by the banker's algorithm.
//!
//! Source: Dijkstra, "Cooperating sequential processes", 1965.
//!
//! A robot that knows its program declares the slots that it may need before it next holds none. A slot is granted
//! only if every robot that could finish before the grant can still finish after it: in some order, each robot gets
//! all slots that it declared, and robots that have finished have released their slots. If all robots keep to their
//! declarations, they never wait for each other in a cycle. A robot without a declaration is assumed to need no more
//! than it has; its cycles are only detected ([`WaitForGraph`](crate::WaitForGraph)).
//!
//! Younger requests may overtake an older one that waits for this reason, but not for ever: a robot that holds
//! nothing does not start while an older request waits and the declared slots of the two overlap.

use std::sync::atomic::Ordering::SeqCst;

use super::shared_state::{InjectedFault, SharedState};
use crate::{RobotSet, RobotSlot, SlotId};

/// Marks a declaration; the bits below are slots.
pub(super) const DECLARED: u64 = 1 << 63;
/// Number of slots that a declaration can name.
pub(super) const MAX_SLOTS: usize = 63;

/// The slots that are held and declared at one instant.
pub(super) struct SafeOrder<'a> {
    state: &'a SharedState,
    now_s: f64,
    /// Bits, per robot, of the slots that it holds or occupies.
    held: [u64; RobotSet::CAPACITY],
    /// Bits, per robot, of the slots that it declared.
    claims: [u64; RobotSet::CAPACITY],
    /// Silent robots; they keep what they hold.
    silent: RobotSet,
}

impl<'a> SafeOrder<'a> {
    /// The present holdings and declarations; `None` if no robot has declared anything.
    pub(super) fn of(state: &'a SharedState, now_s: f64) -> Option<Self> {
        if state.robots.iter().all(|r| r.claims.load(SeqCst) == 0) || state.has(InjectedFault::NoSafeOrder) {
            return None;
        }
        let none = [0; RobotSet::CAPACITY];
        let mut order = Self { state, now_s, held: none, claims: none, silent: RobotSet::default() };
        for (i, entry) in state.robots.iter().enumerate().take(RobotSet::CAPACITY) {
            let robot = RobotSlot(i);
            order.claims[i] = entry.claims.load(SeqCst) & !DECLARED;
            for slot in state.all_slots().take(MAX_SLOTS) {
                if state.holder(slot) == Some(robot) || state.occupancy(slot, robot).occupies() {
                    order.held[i] |= 1 << slot.0;
                    if state.is_silent(slot, robot, now_s) {
                        order.silent.insert(robot);
                    }
                }
            }
        }
        Some(order)
    }

    /// The state before the robot acquired the slot.
    pub(super) fn without(mut self, slot: SlotId, robot: RobotSlot) -> Self {
        self.held[robot.0] &= !(1 << slot.0);
        self
    }

    fn robots(&self) -> impl Iterator<Item = RobotSlot> + use<> {
        (0..self.state.robots.len().min(RobotSet::CAPACITY)).map(RobotSlot)
    }

    /// The robots that can, in some order, get all slots that they need, if `robot` also holds the slots `more`.
    fn finishing(&self, robot: RobotSlot, more: u64) -> RobotSet {
        let held = |r: RobotSlot| if r == robot { self.held[r.0] | more } else { self.held[r.0] };
        let mut done = RobotSet::default();
        loop {
            let taken = |me: RobotSlot, done: RobotSet| {
                self.robots().filter(|o| *o != me && !done.contains(*o)).fold(0, |bits, o| bits | held(o))
            };
            let can_finish = |r: &RobotSlot| {
                !done.contains(*r) && !self.silent.contains(*r) && self.claims[r.0] & !held(*r) & taken(*r, done) == 0
            };
            let Some(next) = self.robots().find(can_finish) else { return done };
            done.insert(next);
        }
    }

    /// True if every robot that can finish now can still finish after the slot is granted to `robot`.
    pub(super) fn allows(&self, slot: SlotId, robot: RobotSlot) -> bool {
        let before = self.finishing(robot, 0);
        let holds_any = self.held[robot.0] != 0;
        if !before.contains(robot) {
            // The declared needs of the robot cannot all be met now. If it holds nothing, it waits; otherwise no order of
            // grants helps, and it may need less than declared.
            return holds_any;
        }
        let after = self.finishing(robot, 1 << slot.0);
        before.difference(after).is_empty()
    }

    /// A robot that holds a slot that `robot` needs; if no robot does, one that holds any slot.
    pub(super) fn blocker(&self, slot: SlotId, robot: RobotSlot) -> Option<RobotSlot> {
        let needs = self.claims[robot.0] | 1 << slot.0;
        let others = || self.robots().filter(|o| *o != robot);
        let holds = |bits: u64| others().find(move |o| self.held[o.0] & bits != 0);
        holds(needs).or_else(|| holds(u64::MAX))
    }

    /// A robot with an older request that waits only for the safe order, if `robot` holds nothing and the needs of the
    /// two overlap.
    pub(super) fn older_waiting(&self, slot: SlotId, robot: RobotSlot, ticket: u64) -> Option<RobotSlot> {
        if self.held[robot.0] != 0 {
            return None;
        }
        let state = self.state;
        let needs = self.claims[robot.0] | 1 << slot.0;
        let waits = |other: &RobotSlot| {
            state.all_slots().any(|s| {
                let theirs = state.ticket(s, *other);
                (1..ticket).contains(&theirs)
                    && !state.is_silent(s, *other, self.now_s)
                    && (self.claims[other.0] | 1 << s.0) & needs != 0
                    && state.holder(s).is_none()
                    && self.finishing(*other, 0).contains(*other)
                    && !self.allows(s, *other)
            })
        };
        self.robots().filter(|o| *o != robot).find(waits)
    }
}
