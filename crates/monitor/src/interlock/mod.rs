//! Regions that robots exchange (S1.8): a board of locks and of who is where.
//!
//! Every controller publishes, each tick, where it is for every slot, and then asks for the slots whose warning zone it
//! is in. A slot is granted to one robot at a time, in the order of asking, and only while it is known of every other
//! robot that it is outside and can stop outside: what is unknown counts as occupied. A slot is given back only by a
//! robot that is outside and can stop outside. A robot that vanishes while it holds a slot keeps it until the integrator
//! clears it; one that falls silent elsewhere blocks further grants until it speaks again or is cleared.
//!
//! Robots that declare what they will need are granted a slot only while all of them can still get what they need in
//! some order (`order.rs`). All operations are sequences of single atomic steps: no lock, no wait, no allocation after
//! construction. `docs/laws.md`, section 11, states what is guaranteed and what was model-checked (`check.rs`).
//!
//! ```
//! use elbowroom_monitor::{Board, Grant, RobotSlot, SlotId, Stay};
//! let board = Board::new(&["left", "right"], &["exchange"]);
//! let (left, right, slot) = (RobotSlot(0), RobotSlot(1), SlotId(0));
//! board.expect(slot, left);
//! board.expect(slot, right);
//! board.publish(slot, left, Stay::Warning, 0.0);
//! assert_eq!(board.request(slot, left, 0.0), Grant::Unknown(right)); // nobody knows where `right` is
//! board.publish(slot, right, Stay::Outside, 0.0);
//! assert_eq!(board.request(slot, left, 0.0), Grant::Held);
//! board.publish(slot, right, Stay::Warning, 0.0);
//! assert_eq!(board.request(slot, right, 0.0), Grant::Waiting(left));
//! ```

#[cfg(test)]
mod check;
mod circle;
mod group;
mod order;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, AtomicU64, Ordering::SeqCst};

use crate::AccessClass;

pub use group::group_overlapping;

/// Index of a robot on a [`Board`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct RobotSlot(pub usize);

/// Index of a lock on a [`Board`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SlotId(pub usize);

/// Where a robot is, seen from a slot's regions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stay {
    /// Never said. What was said too long ago counts the same.
    Unknown,
    /// Beyond the warning zone, and able to stop outside the regions.
    Outside,
    /// In the warning zone, and able to stop outside the regions.
    Warning,
    /// Outside the regions, but it is not proven that the robot can stop there: it moves too fast, or how it brakes is
    /// not known.
    Committed,
    /// Inside.
    Inside,
}

impl Stay {
    fn from_u8(v: u8) -> Self {
        match v {
            1 => Self::Outside,
            2 => Self::Warning,
            3 => Self::Committed,
            4 => Self::Inside,
            _ => Self::Unknown,
        }
    }

    /// True where the robot is in the slot's regions or may get there whatever it is told now: [`Stay::Committed`] and
    /// [`Stay::Inside`]. Nobody else is granted the slot then, and the robot does not give it back.
    pub fn occupies(self) -> bool {
        self >= Self::Committed
    }
}

/// The board's answer to a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grant {
    /// The robot holds the slot.
    Held,
    /// Another robot holds it, occupies it, asked first, or must come first so that all can finish.
    Waiting(RobotSlot),
    /// Nobody knows where this robot is.
    Unknown(RobotSlot),
    /// Robots wait for each other in a circle, and each is inside what the next one needs.
    Deadlock,
}

/// Locks and whereabouts shared by several controllers.
#[derive(Debug)]
pub struct Board {
    robots: Box<[Member]>,
    slots: Box<[Slot]>,
    next_ticket: AtomicU64,
    /// What a robot said longer ago than this (s) is not known any more.
    patience_s: f64,
    #[cfg(test)]
    planted: AtomicU8,
}

/// Faults of the protocol, each of which the model check must find. None is ever there outside of tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
enum Planted {
    GrantWhileOccupied = 1,
    KeepsOldNews,
    SilenceIsAbsence,
    YieldsCommitted,
    NoOrder,
    StrictQueue,
    NoSecondLook,
}

#[derive(Debug)]
struct Member {
    name: String,
    /// Slots it may still need, one bit each, and [`order::DECLARED`]; 0 where it declared nothing.
    claims: AtomicU64,
}

#[derive(Debug)]
struct Slot {
    name: String,
    /// Robot, plus 1; 0 for nobody.
    holder: AtomicU32,
    entries: Box<[Entry]>,
}

/// One robot at one slot.
#[derive(Debug, Default)]
struct Entry {
    expected: AtomicBool,
    stay: AtomicU8,
    /// Bits of the time of the last publication.
    seen_s: AtomicU64,
    /// Place in the queue; 0 for none.
    ticket: AtomicU64,
}

impl Board {
    /// A board for these robots and locks. Nobody is expected at any slot yet: see [`Board::expect`].
    pub fn new(robots: &[&str], slots: &[&str]) -> Self {
        let member = |name: &&str| Member { name: (*name).into(), claims: AtomicU64::new(0) };
        let slot = |name: &&str| Slot {
            name: (*name).into(),
            holder: AtomicU32::new(0),
            entries: robots.iter().map(|_| Entry::default()).collect(),
        };
        Self {
            robots: robots.iter().map(member).collect(),
            slots: slots.iter().map(slot).collect(),
            next_ticket: AtomicU64::new(1),
            patience_s: 0.1,
            #[cfg(test)]
            planted: AtomicU8::new(0),
        }
    }

    /// With another time (s) after which silence makes a robot's whereabouts unknown; the default is 0.1 s. It must be
    /// longer than the robots' ticks.
    #[must_use]
    pub fn patience(self, patience_s: f64) -> Self {
        Self { patience_s, ..self }
    }

    /// Says that a robot can come to a slot: from now on the slot is granted only while its whereabouts are known.
    /// Monitors say it for themselves when they are built; say it for robots of other processes before the first tick.
    pub fn expect(&self, slot: SlotId, robot: RobotSlot) {
        self.entry(slot, robot).expected.store(true, SeqCst);
    }

    /// Number of robots.
    pub fn robots(&self) -> usize {
        self.robots.len()
    }

    /// Number of slots.
    pub fn slots(&self) -> usize {
        self.slots.len()
    }

    /// A robot's name.
    pub fn robot_name(&self, robot: RobotSlot) -> &str {
        &self.robots[robot.0].name
    }

    /// A slot's name.
    pub fn slot_name(&self, slot: SlotId) -> &str {
        &self.slots[slot.0].name
    }

    /// Who holds a slot.
    pub fn holder(&self, slot: SlotId) -> Option<RobotSlot> {
        let holder = self.slots[slot.0].holder.load(SeqCst);
        (holder > 0).then(|| RobotSlot(holder as usize - 1))
    }

    /// Where a robot last said it is.
    pub fn stay(&self, slot: SlotId, robot: RobotSlot) -> Stay {
        Stay::from_u8(self.entry(slot, robot).stay.load(SeqCst))
    }

    /// Publishes where a robot is. A robot outside gives back what it holds and leaves the queue, so `Outside` may be
    /// said only by one that can stop outside; say [`Stay::Committed`] otherwise. Publish for all slots before the
    /// first [`Board::request`] of a tick.
    pub fn publish(&self, slot: SlotId, robot: RobotSlot, stay: Stay, now_s: f64) {
        let entry = self.entry(slot, robot);
        entry.expected.store(true, SeqCst);
        entry.seen_s.store(now_s.to_bits(), SeqCst);
        entry.stay.store(stay as u8, SeqCst);
        if stay == Stay::Outside {
            self.give_back(slot, robot);
            self.leave_queue(slot, robot);
        }
    }

    /// Asks for a slot; the answer is final for this tick, except that a request for another slot may give back what
    /// this one gave ([`Board::holder`] tells). Ask again each tick while in the warning zone.
    pub fn request(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Grant {
        self.look(slot, robot, now_s).unwrap_or_else(|| self.take(slot, robot, now_s))
    }

    /// The answer to a request, or `None` where the slot may be taken.
    fn look(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Option<Grant> {
        if self.holder(slot) == Some(robot) {
            return Some(self.confirm(slot, robot, now_s));
        }
        self.join_queue(slot, robot);
        let obstacle = self.obstacle(slot, robot, now_s)?;
        if !self.in_circle(robot, now_s) {
            return Some(obstacle);
        }
        if self.circle_is_stuck(robot, now_s) {
            return Some(Grant::Deadlock);
        }
        self.yield_held(robot, now_s);
        Some(obstacle)
    }

    /// Says that a silent robot is outside and stands there: the integrator has looked. It is not waited for until it
    /// speaks again. Returns false where the class may not, and where the robot is not silent: one that speaks says
    /// itself where it is.
    pub fn clear(&self, slot: SlotId, robot: RobotSlot, who: AccessClass, now_s: f64) -> bool {
        let speaks = self.stay(slot, robot) != Stay::Unknown && !self.is_silent(slot, robot, now_s);
        let allowed = who >= AccessClass::Integrator && !speaks;
        if allowed {
            self.publish(slot, robot, Stay::Outside, now_s);
            self.entry(slot, robot).expected.store(false, SeqCst);
        }
        allowed
    }

    #[cfg(test)]
    fn has(&self, fault: Planted) -> bool {
        self.planted.load(SeqCst) == fault as u8
    }

    #[cfg(not(test))]
    #[allow(clippy::unused_self, reason = "asked for in tests")]
    fn has(&self, _: Planted) -> bool {
        false
    }

    /// What a robot said of a slot counts no more, because one of its regions was switched on: where the robot is has to
    /// be published anew before anybody is granted the slot.
    pub(crate) fn forget(&self, slot: SlotId, robot: RobotSlot) {
        if !self.has(Planted::KeepsOldNews) {
            self.entry(slot, robot).stay.store(Stay::Unknown as u8, SeqCst);
        }
    }

    fn entry(&self, slot: SlotId, robot: RobotSlot) -> &Entry {
        &self.slots[slot.0].entries[robot.0]
    }

    fn all_slots(&self) -> impl Iterator<Item = SlotId> + use<> {
        (0..self.slots.len()).map(SlotId)
    }

    fn ticket(&self, slot: SlotId, robot: RobotSlot) -> u64 {
        self.entry(slot, robot).ticket.load(SeqCst)
    }

    fn join_queue(&self, slot: SlotId, robot: RobotSlot) {
        let entry = self.entry(slot, robot);
        if entry.ticket.load(SeqCst) == 0 {
            entry.ticket.store(self.next_ticket.fetch_add(1, SeqCst), SeqCst);
        }
    }

    fn leave_queue(&self, slot: SlotId, robot: RobotSlot) {
        self.entry(slot, robot).ticket.store(0, SeqCst);
    }

    fn is_silent(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> bool {
        let age_s = now_s - f64::from_bits(self.entry(slot, robot).seen_s.load(SeqCst));
        // A time that is no number proves nothing.
        age_s.is_nan() || age_s > self.patience_s
    }

    /// What keeps `robot` from taking the slot now.
    fn obstacle(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Option<Grant> {
        if let Some(holder) = self.holder(slot) {
            return Some(Grant::Waiting(holder));
        }
        if let Some(occupied) = self.occupied(slot, robot, now_s) {
            return Some(occupied);
        }
        // Whoever is in already is before everybody who could wait.
        if self.stay(slot, robot).occupies() {
            return None;
        }
        self.turn(slot, robot, now_s).map(Grant::Waiting)
    }

    /// The robot that is in the slot's regions, cannot stop outside, or might be anywhere.
    fn occupied(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Option<Grant> {
        self.others(slot, robot).find_map(|other| match self.stay(slot, other) {
            Stay::Unknown => Some(Grant::Unknown(other)),
            _ if self.is_silent(slot, other, now_s) && !self.has(Planted::SilenceIsAbsence) => {
                Some(Grant::Unknown(other))
            }
            stay if stay.occupies() && !self.has(Planted::GrantWhileOccupied) => Some(Grant::Waiting(other)),
            _ => None,
        })
    }

    fn others(&self, slot: SlotId, robot: RobotSlot) -> impl Iterator<Item = RobotSlot> + '_ {
        let expected = move |o: &RobotSlot| *o != robot && self.entry(slot, *o).expected.load(SeqCst);
        (0..self.robots.len()).map(RobotSlot).filter(expected)
    }

    /// A holder's request. While it can stop outside it goes on only if all others are still known to be outside: one may
    /// have got in without the slot (by starting there, or because a region moved or was switched on), or fallen silent.
    fn confirm(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Grant {
        self.leave_queue(slot, robot);
        let obstacle = if self.stay(slot, robot).occupies() { None } else { self.occupied(slot, robot, now_s) };
        let Some(obstacle) = obstacle else { return Grant::Held };
        self.give_back(slot, robot);
        self.join_queue(slot, robot);
        obstacle
    }

    fn take(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Grant {
        let me = robot.0 as u32 + 1;
        if let Err(holder) = self.slots[slot.0].holder.compare_exchange(0, me, SeqCst, SeqCst) {
            return Grant::Waiting(RobotSlot(holder as usize - 1));
        }
        // What was seen before the slot was taken may have changed meanwhile: another robot may have got in, or two
        // slots may have been taken at once that only one of them may have been.
        let seen = self.occupied(slot, robot, now_s).or_else(|| self.breaks_order(slot, robot, now_s));
        if let Some(obstacle) = seen.filter(|_| !self.stay(slot, robot).occupies() && !self.has(Planted::NoSecondLook))
        {
            self.give_back(slot, robot);
            return obstacle;
        }
        self.leave_queue(slot, robot);
        Grant::Held
    }

    fn give_back(&self, slot: SlotId, robot: RobotSlot) {
        // Only the holder's own release changes anything.
        let _ = self.slots[slot.0].holder.compare_exchange(robot.0 as u32 + 1, 0, SeqCst, SeqCst);
    }
}
