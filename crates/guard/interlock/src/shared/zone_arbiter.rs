//! The zone arbiter of exchange regions.

use std::sync::atomic::Ordering::SeqCst;

use super::safe_order::{DECLARED, MAX_SLOTS, SafeOrder};
use super::shared_state::{InjectedFault, SharedState};
use crate::{AccessClass, Grant, Occupancy, RobotSet, RobotSlot, SlotId, WaitForGraph};

/// An arbiter in shared memory: locks and published occupancies that several controllers share.
#[derive(Debug)]
pub struct ZoneArbiter {
    pub(super) state: SharedState,
}

impl ZoneArbiter {
    /// Creates an arbiter for these robots and slots. Robots are registered at slots with [`ZoneArbiter::register`].
    pub fn new(robots: &[&str], slots: &[&str]) -> Self {
        Self { state: SharedState::new(robots, slots) }
    }

    /// Sets the time (s) without a publication after which a robot's occupancy is not known; the default is 0.1 s. It
    /// must be longer than the ticks of the robots.
    #[must_use]
    pub fn silence_timeout(self, silence_timeout_s: f64) -> Self {
        Self { state: SharedState { silence_timeout_s, ..self.state } }
    }

    /// Registers a robot at a slot: from now on the slot is granted to other robots only while this robot's occupancy is
    /// known. Monitors register their robot when they are built; register robots of other processes before the first
    /// tick.
    pub fn register(&self, slot: SlotId, robot: RobotSlot) {
        self.state.entry(slot, robot).registered.store(true, SeqCst);
    }

    /// Number of robots.
    pub fn robots(&self) -> usize {
        self.state.robots.len()
    }

    /// Number of slots.
    pub fn slots(&self) -> usize {
        self.state.slots.len()
    }

    /// A robot's name.
    pub fn robot_name(&self, robot: RobotSlot) -> &str {
        &self.state.robots[robot.0].name
    }

    /// A slot's name.
    pub fn slot_name(&self, slot: SlotId) -> &str {
        &self.state.slots[slot.0].name
    }

    /// The robot that holds a slot.
    pub fn holder(&self, slot: SlotId) -> Option<RobotSlot> {
        self.state.holder(slot)
    }

    /// The last published occupancy of a robot.
    pub fn occupancy(&self, slot: SlotId, robot: RobotSlot) -> Occupancy {
        self.state.occupancy(slot, robot)
    }

    /// Publishes a robot's occupancy. Publish for all slots before the first [`ZoneArbiter::request`] of a tick.
    ///
    /// `Outside` releases the slot and removes the robot from its queue, so publish it only if the robot can stop
    /// outside; otherwise publish [`Occupancy::Committed`].
    pub fn publish(&self, slot: SlotId, robot: RobotSlot, occupancy: Occupancy, now_s: f64) {
        let entry = self.state.entry(slot, robot);
        entry.registered.store(true, SeqCst);
        entry.published_s.store(now_s.to_bits(), SeqCst);
        entry.occupancy.store(occupancy as u8, SeqCst);
        if occupancy == Occupancy::Outside {
            self.state.release(slot, robot);
            self.state.leave_queue(slot, robot);
        }
    }

    /// Requests a slot. The answer is final for this tick, except that a request for another slot may release this one
    /// (see [`ZoneArbiter::holder`]). Request again in each tick in the warning zone.
    pub fn request(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Grant {
        self.check(slot, robot, now_s).unwrap_or_else(|| self.acquire(slot, robot, now_s))
    }

    /// The answer to a request, or `None` if the slot may be acquired.
    pub(super) fn check(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Option<Grant> {
        if self.holder(slot) == Some(robot) {
            return Some(self.confirm(slot, robot, now_s));
        }
        self.state.join_queue(slot, robot);
        let refusal = self.refusal(slot, robot, now_s)?;
        let cycle = self.wait_for_graph(now_s).cycle(robot);
        if cycle.is_empty() {
            return Some(refusal);
        }
        if self.is_stuck(cycle) {
            return Some(Grant::Deadlock);
        }
        if self.yielding_robot(cycle) == Some(robot) {
            for held in self.state.all_slots().filter(|s| self.holder(*s) == Some(robot)) {
                self.state.release(held, robot);
            }
        }
        Some(refusal)
    }

    /// Acquires a slot that [`ZoneArbiter::check`] found to be free.
    pub(super) fn acquire(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Grant {
        if let Err(holder) = self.state.acquire(slot, robot) {
            return Grant::Waiting(holder);
        }
        // The state may have changed since the check: another robot may have entered, or two slots may have been acquired at
        // once of which only one is allowed.
        let refusal = self.occupied(slot, robot, now_s).or_else(|| self.order_violation(slot, robot, now_s));
        let must_keep = || self.occupancy(slot, robot).occupies() || self.state.has(InjectedFault::NoSecondCheck);
        if let Some(refusal) = refusal.filter(|_| !must_keep()) {
            self.state.release(slot, robot);
            return refusal;
        }
        self.state.leave_queue(slot, robot);
        Grant::Held
    }

    /// Declares that a silent robot is at rest outside the regions, as seen by the integrator. The robot does not block
    /// the slot until it publishes again. Returns false if the access class is too low or the robot is not silent.
    pub fn clear(&self, slot: SlotId, robot: RobotSlot, who: AccessClass, now_s: f64) -> bool {
        let is_silent = self.occupancy(slot, robot) == Occupancy::Unknown || self.state.is_silent(slot, robot, now_s);
        let allowed = who >= AccessClass::Integrator && is_silent;
        if allowed {
            self.publish(slot, robot, Occupancy::Outside, now_s);
            self.state.entry(slot, robot).registered.store(false, SeqCst);
        }
        allowed
    }

    /// Declares all slots that a robot may need from now on until it next holds none of them. These are the slots of a
    /// stretch of its program in which the robot moves from slot to slot without leaving all of them.
    ///
    /// Declare the rest of the stretch, or the next stretch, as the program advances; while a slot is held, a
    /// declaration may only shrink. Declarations have an effect in arbiters of at most 63 slots and 128 robots.
    ///
    /// ```
    /// use elbowroom_interlock::{Grant, Occupancy, RobotSlot, SlotId, ZoneArbiter};
    /// let arbiter = ZoneArbiter::new(&["left", "right"], &["a", "b"]);
    /// let ([left, right], [a, b]) = ([RobotSlot(0), RobotSlot(1)], [SlotId(0), SlotId(1)]);
    /// for (slot, robot) in [(a, left), (a, right), (b, left), (b, right)] {
    ///     arbiter.publish(slot, robot, Occupancy::Outside, 0.0);
    /// }
    /// arbiter.declare(left, [a, b]);
    /// arbiter.declare(right, [a, b]);
    /// arbiter.publish(a, left, Occupancy::Warning, 0.0);
    /// arbiter.publish(b, right, Occupancy::Warning, 0.0);
    /// assert_eq!(arbiter.request(a, left, 0.0), Grant::Held);
    /// // Otherwise each would hold what the other needs next.
    /// assert_eq!(arbiter.request(b, right, 0.0), Grant::Waiting(left));
    /// ```
    pub fn declare(&self, robot: RobotSlot, slots: impl IntoIterator<Item = SlotId>) {
        let fits = self.slots() <= MAX_SLOTS && self.robots() <= RobotSet::CAPACITY;
        let bits = slots.into_iter().filter(|s| s.0 < MAX_SLOTS).fold(0, |bits, s| bits | 1 << s.0);
        self.state.robots[robot.0].claims.store(if fits { bits | DECLARED } else { 0 }, SeqCst);
    }

    /// The robots that wait for each other in a cycle with this one, each with a slot that it waits for; empty if this
    /// robot is in no cycle. A silent robot is never in a cycle: it may publish again, or be cleared. Allocates: do not
    /// call it in a tick.
    pub fn wait_cycle(&self, robot: RobotSlot, now_s: f64) -> Vec<(RobotSlot, SlotId)> {
        let cycle = self.wait_for_graph(now_s).cycle(robot);
        let is_awaited = |s: &SlotId, r: RobotSlot| {
            self.state.ticket(*s, r) > 0 && self.blockers(*s, r, now_s).any(|b| cycle.contains(b))
        };
        let slot = |r: RobotSlot| self.state.all_slots().find(|s| is_awaited(s, r));
        cycle.iter().filter_map(|r| Some((r, slot(r)?))).collect()
    }

    /// Invalidates a robot's published occupancy of a slot, because one of its regions was switched on: the robot must
    /// publish again before any other robot is granted the slot.
    pub fn invalidate(&self, slot: SlotId, robot: RobotSlot) {
        if !self.state.has(InjectedFault::KeepsStaleOccupancy) {
            self.state.entry(slot, robot).occupancy.store(Occupancy::Unknown as u8, SeqCst);
        }
    }

    /// Builds the wait-for graph: a robot waits for the robots that block a slot that it has requested. A silent robot
    /// is never in a cycle: it may publish again, or be cleared.
    fn wait_for_graph(&self, now_s: f64) -> WaitForGraph {
        let mut graph = WaitForGraph::default();
        for slot in self.state.all_slots() {
            let waiting = (0..self.robots()).map(RobotSlot).filter(|robot| self.state.ticket(slot, *robot) > 0);
            for robot in waiting {
                self.blockers(slot, robot, now_s).for_each(|blocker| graph.add(robot, blocker));
            }
        }
        graph
    }

    /// The robots that block the slot for `robot`: its holder and the robots that occupy it, unless they are silent.
    fn blockers(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> impl Iterator<Item = RobotSlot> + '_ {
        let holder = self.holder(slot);
        self.state.others(slot, robot).filter(move |other| {
            let blocks = holder == Some(*other) || self.occupancy(slot, *other).occupies();
            blocks && !self.state.is_silent(slot, *other, now_s)
        })
    }

    /// Whether no robot of the cycle can yield: each is inside a region of some slot, or may come to rest there beside one
    /// that is inside.
    fn is_stuck(&self, cycle: RobotSet) -> bool {
        let is_inside = |slot, robot| self.occupancy(slot, robot) == Occupancy::Inside;
        let another_is_inside = |slot, robot| cycle.iter().any(|other| other != robot && is_inside(slot, other));
        let cannot_yield = |slot, robot| match self.occupancy(slot, robot) {
            Occupancy::Inside => true,
            Occupancy::Committed => another_is_inside(slot, robot),
            _ => false,
        };
        cycle.iter().all(|robot| self.state.all_slots().any(|slot| cannot_yield(slot, robot)))
    }

    /// The robot that yields in the cycle: the first (by index) that holds a slot and can stop outside all slots that it
    /// holds.
    fn yielding_robot(&self, cycle: RobotSet) -> Option<RobotSlot> {
        let can_yield = |r: &RobotSlot| {
            let mut held = self.state.all_slots().filter(|s| self.holder(*s) == Some(*r)).peekable();
            let may_release = |s| !self.occupancy(s, *r).occupies() || self.state.has(InjectedFault::YieldsCommitted);
            held.peek().is_some() && held.all(may_release)
        };
        cycle.iter().find(can_yield)
    }

    /// Why `robot` may not acquire the slot now.
    fn refusal(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Option<Grant> {
        if let Some(holder) = self.holder(slot) {
            return Some(Grant::Waiting(holder));
        }
        if let Some(occupied) = self.occupied(slot, robot, now_s) {
            return Some(occupied);
        }
        // A robot that already occupies the slot precedes all robots that can wait.
        if self.occupancy(slot, robot).occupies() {
            return None;
        }
        self.predecessor(slot, robot, now_s).map(Grant::Waiting)
    }

    /// Refuses the slot if another robot occupies it, or if the occupancy of another robot is not known.
    fn occupied(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Option<Grant> {
        let state = &self.state;
        state.others(slot, robot).find_map(|other| match state.occupancy(slot, other) {
            Occupancy::Unknown => Some(Grant::Unknown(other)),
            _ if state.is_silent(slot, other, now_s) && !state.has(InjectedFault::SilenceIsAbsence) => {
                Some(Grant::Unknown(other))
            }
            o if o.occupies() && !state.has(InjectedFault::GrantWhileOccupied) => Some(Grant::Waiting(other)),
            _ => None,
        })
    }

    /// Repeats the checks for the holder. A holder that can stop outside keeps the slot only while all other robots are
    /// known to be outside. Another robot may have entered without the slot (by starting there, by gripping a part there,
    /// or because a region moved or was switched on), or become silent. A holder that may come to rest inside keeps the
    /// slot, but does not go on towards a robot that is inside.
    fn confirm(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Grant {
        self.state.leave_queue(slot, robot);
        let refusal = match self.occupancy(slot, robot) {
            Occupancy::Inside => None,
            Occupancy::Committed => {
                let is_inside = |other: &RobotSlot| self.occupancy(slot, *other) == Occupancy::Inside;
                self.state.others(slot, robot).find(is_inside).map(Grant::Waiting)
            }
            _ => self.occupied(slot, robot, now_s).inspect(|_| self.state.release(slot, robot)),
        };
        let Some(refusal) = refusal else { return Grant::Held };
        self.state.join_queue(slot, robot);
        refusal
    }

    /// The robot that precedes `robot` at an unoccupied slot.
    fn predecessor(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Option<RobotSlot> {
        let state = &self.state;
        let mine = state.ticket(slot, robot);
        let Some(order) = SafeOrder::of(state, now_s) else {
            return state.others(slot, robot).find(|o| (1..mine).contains(&state.ticket(slot, *o)));
        };
        if !order.allows(slot, robot) {
            return order.blocker(slot, robot);
        }
        if let Some(older) = order.older_waiting(slot, robot, mine) {
            return Some(older);
        }
        state.others(slot, robot).find(|other| {
            let theirs = state.ticket(slot, *other);
            // A robot that may not acquire the slot now does not block others.
            let may_acquire = || order.allows(slot, *other) && order.older_waiting(slot, *other, theirs).is_none();
            (1..mine).contains(&theirs) && (may_acquire() || state.has(InjectedFault::StrictQueue))
        })
    }

    /// Repeats the safe-order test after a slot was acquired: two robots may have acquired one slot each at the same
    /// time.
    fn order_violation(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Option<Grant> {
        let order = SafeOrder::of(&self.state, now_s)?.without(slot, robot);
        if order.allows(slot, robot) { None } else { order.blocker(slot, robot).map(Grant::Waiting) }
    }
}
