//! Regions that robots exchange (S1.8): a board of locks and of who is where.
//!
//! Every controller publishes, each tick, where it is for every slot, and asks for the slots whose warning zone it is
//! in. A slot is granted in the order of asking, to one robot at a time, and only while it is known where all its
//! robots are: what is unknown counts as occupied. A robot that vanishes while it holds a slot keeps it until the
//! integrator clears it; one that falls silent elsewhere blocks further grants until it speaks again or is cleared. All
//! operations are single atomic steps: no lock, no wait, no allocation after construction.
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

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, AtomicU64, Ordering::SeqCst};

use elbowroom_proximity::within;

use crate::{AccessClass, Region};

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
    /// Beyond the warning zone.
    Outside,
    /// In the warning zone.
    Warning,
    /// Inside.
    Inside,
}

impl Stay {
    fn from_u8(v: u8) -> Self {
        match v {
            1 => Self::Outside,
            2 => Self::Warning,
            3 => Self::Inside,
            _ => Self::Unknown,
        }
    }
}

/// The board's answer to a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grant {
    /// The robot holds the slot.
    Held,
    /// Another robot holds it, is inside, or asked first.
    Waiting(RobotSlot),
    /// Nobody knows where this robot is.
    Unknown(RobotSlot),
    /// Robots wait for each other in a circle, and each is inside what the next one needs.
    Deadlock,
}

/// Locks and whereabouts shared by several controllers.
#[derive(Debug)]
pub struct Board {
    robots: Box<[Seat]>,
    slots: Box<[Slot]>,
    /// What a robot said longer ago than this (s) is not known any more.
    patience_s: f64,
}

#[derive(Debug)]
struct Seat {
    name: String,
    /// Slot waited for, plus 1; 0 for none.
    waits_for: AtomicU32,
}

#[derive(Debug)]
struct Slot {
    name: String,
    /// Robot, plus 1; 0 for nobody.
    holder: AtomicU32,
    next_ticket: AtomicU64,
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
        let seat = |name: &&str| Seat { name: (*name).into(), waits_for: AtomicU32::new(0) };
        let slot = |name: &&str| Slot {
            name: (*name).into(),
            holder: AtomicU32::new(0),
            next_ticket: AtomicU64::new(1),
            entries: robots.iter().map(|_| Entry::default()).collect(),
        };
        Self { robots: robots.iter().map(seat).collect(), slots: slots.iter().map(slot).collect(), patience_s: 0.1 }
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

    /// Publishes where a robot is. A robot outside gives back what it holds and leaves the queue.
    pub fn publish(&self, slot: SlotId, robot: RobotSlot, stay: Stay, now_s: f64) {
        let entry = self.entry(slot, robot);
        entry.expected.store(true, SeqCst);
        entry.seen_s.store(now_s.to_bits(), SeqCst);
        entry.stay.store(stay as u8, SeqCst);
        if stay == Stay::Outside {
            self.give_back(slot, robot);
            self.stop_waiting(slot, robot);
        }
    }

    /// Asks for a slot; the answer is final for this tick. Ask again each tick while in the warning zone.
    pub fn request(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Grant {
        if self.holder(slot) == Some(robot) {
            self.stop_waiting(slot, robot);
            return Grant::Held;
        }
        self.queue(slot, robot);
        let Some(obstacle) = self.obstacle(slot, robot, now_s) else {
            return self.take(slot, robot);
        };
        self.robots[robot.0].waits_for.store(slot.0 as u32 + 1, SeqCst);
        if self.in_circle(robot) && !self.yield_held(robot) && self.circle_is_stuck(robot) {
            return Grant::Deadlock;
        }
        obstacle
    }

    /// Says that a silent robot is outside and stays there: the integrator has looked. It is not waited for until it
    /// speaks again. Returns false where the class may not.
    pub fn clear(&self, slot: SlotId, robot: RobotSlot, who: AccessClass, now_s: f64) -> bool {
        let allowed = who >= AccessClass::Integrator;
        if allowed {
            self.publish(slot, robot, Stay::Outside, now_s);
            self.entry(slot, robot).expected.store(false, SeqCst);
        }
        allowed
    }

    fn entry(&self, slot: SlotId, robot: RobotSlot) -> &Entry {
        &self.slots[slot.0].entries[robot.0]
    }

    fn queue(&self, slot: SlotId, robot: RobotSlot) {
        let entry = self.entry(slot, robot);
        if entry.ticket.load(SeqCst) == 0 {
            entry.ticket.store(self.slots[slot.0].next_ticket.fetch_add(1, SeqCst), SeqCst);
        }
    }

    /// What keeps `robot` from taking the slot now.
    fn obstacle(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Option<Grant> {
        if let Some(holder) = self.holder(slot) {
            return Some(Grant::Waiting(holder));
        }
        let mine = self.entry(slot, robot).ticket.load(SeqCst);
        self.others(slot, robot).find_map(|other| {
            let entry = self.entry(slot, other);
            let ticket = entry.ticket.load(SeqCst);
            let silent = now_s - f64::from_bits(entry.seen_s.load(SeqCst)) > self.patience_s;
            match self.stay(slot, other) {
                _ if silent => Some(Grant::Unknown(other)),
                Stay::Unknown => Some(Grant::Unknown(other)),
                Stay::Inside => Some(Grant::Waiting(other)),
                _ if ticket > 0 && ticket < mine => Some(Grant::Waiting(other)),
                _ => None,
            }
        })
    }

    fn others(&self, slot: SlotId, robot: RobotSlot) -> impl Iterator<Item = RobotSlot> + '_ {
        let expected = move |o: &RobotSlot| *o != robot && self.entry(slot, *o).expected.load(SeqCst);
        (0..self.robots.len()).map(RobotSlot).filter(expected)
    }

    fn take(&self, slot: SlotId, robot: RobotSlot) -> Grant {
        let me = robot.0 as u32 + 1;
        match self.slots[slot.0].holder.compare_exchange(0, me, SeqCst, SeqCst) {
            Ok(_) => {
                self.stop_waiting(slot, robot);
                Grant::Held
            }
            Err(holder) => Grant::Waiting(RobotSlot(holder as usize - 1)),
        }
    }

    fn give_back(&self, slot: SlotId, robot: RobotSlot) {
        // Only the holder's own release changes anything.
        let _ = self.slots[slot.0].holder.compare_exchange(robot.0 as u32 + 1, 0, SeqCst, SeqCst);
    }

    fn stop_waiting(&self, slot: SlotId, robot: RobotSlot) {
        self.entry(slot, robot).ticket.store(0, SeqCst);
        let waits_for = slot.0 as u32 + 1;
        let _ = self.robots[robot.0].waits_for.compare_exchange(waits_for, 0, SeqCst, SeqCst);
    }

    /// The robot that holds what `robot` waits for.
    fn blocker(&self, robot: RobotSlot) -> Option<RobotSlot> {
        let waits_for = self.robots[robot.0].waits_for.load(SeqCst);
        (waits_for > 0).then(|| self.holder(SlotId(waits_for as usize - 1))).flatten()
    }

    fn circle(&self, robot: RobotSlot) -> impl Iterator<Item = RobotSlot> + '_ {
        std::iter::successors(self.blocker(robot), |r| self.blocker(*r)).take(self.robots.len())
    }

    fn in_circle(&self, robot: RobotSlot) -> bool {
        self.circle(robot).any(|r| r == robot)
    }

    /// True where the robot holds a slot and is inside it: then it cannot give it back.
    fn is_inside_something_held(&self, robot: RobotSlot) -> bool {
        let mut slots = (0..self.slots.len()).map(SlotId);
        slots.any(|s| self.holder(s) == Some(robot) && self.stay(s, robot) == Stay::Inside)
    }

    /// The way out of a circle of waiting robots: the first of them (by index) that is inside nothing it holds gives
    /// everything back. It is in warning zones only, so the law keeps it out of what it gave back.
    fn yield_held(&self, robot: RobotSlot) -> bool {
        let can_yield = |r: RobotSlot| !self.is_inside_something_held(r);
        let chosen = self.circle(robot).filter(|r| can_yield(*r)).map(|r| r.0).min();
        if chosen != Some(robot.0) {
            return false;
        }
        for slot in (0..self.slots.len()).map(SlotId) {
            if self.holder(slot) == Some(robot) {
                self.give_back(slot, robot);
                self.entry(slot, robot).ticket.store(0, SeqCst);
            }
        }
        true
    }

    fn circle_is_stuck(&self, robot: RobotSlot) -> bool {
        self.circle(robot).all(|r| self.is_inside_something_held(r))
    }
}

/// Groups exchange regions whose warning zones overlap, or that move: a group is one slot, granted as a whole, so that
/// two robots can never each hold what the other needs next. Returns the group's number for each region.
pub fn group_overlapping(regions: &[&Region]) -> Vec<usize> {
    let mut group: Vec<usize> = (0..regions.len()).collect();
    for i in 0..regions.len() {
        for j in 0..i {
            if zones_meet(regions[i], regions[j]) {
                let (keep, drop) = (group[j].min(group[i]), group[j].max(group[i]));
                group.iter_mut().filter(|g| **g == drop).for_each(|g| *g = keep);
            }
        }
    }
    let mut names: Vec<usize> = group.clone();
    names.sort_unstable();
    names.dedup();
    group.iter().map(|g| names.partition_point(|n| n < g)).collect()
}

fn zones_meet(a: &Region, b: &Region) -> bool {
    if a.follow.is_some() || b.follow.is_some() {
        return true;
    }
    let at = |r: &Region| r.anchor * r.shape_in_anchor;
    within(&a.shape, &at(a), &b.shape, &at(b), a.warning_m + b.warning_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use elbowroom_spatial::Vec3;
    use std::sync::Arc;
    use std::sync::atomic::AtomicUsize;

    const A: SlotId = SlotId(0);
    const B: SlotId = SlotId(1);
    const LEFT: RobotSlot = RobotSlot(0);
    const RIGHT: RobotSlot = RobotSlot(1);

    fn board() -> Board {
        let board = Board::new(&["left", "right"], &["a", "b"]);
        for slot in [A, B] {
            for robot in [LEFT, RIGHT] {
                board.expect(slot, robot);
                board.publish(slot, robot, Stay::Outside, 0.0);
            }
        }
        board
    }

    #[test]
    fn first_come_first_served_and_given_back_when_outside() {
        let b = board();
        b.publish(A, LEFT, Stay::Warning, 0.0);
        b.publish(A, RIGHT, Stay::Warning, 0.0);
        assert_eq!(b.request(A, RIGHT, 0.0), Grant::Held);
        assert_eq!(b.request(A, LEFT, 0.0), Grant::Waiting(RIGHT));
        b.publish(A, RIGHT, Stay::Outside, 0.05);
        assert_eq!(b.request(A, LEFT, 0.05), Grant::Held);
    }

    #[test]
    fn a_robot_that_vanishes_inside_keeps_the_slot_until_cleared() {
        let b = board();
        b.publish(A, LEFT, Stay::Inside, 0.0);
        assert_eq!(b.request(A, LEFT, 0.0), Grant::Held);
        for t in 1..1000 {
            b.publish(A, RIGHT, Stay::Warning, f64::from(t));
            assert_eq!(b.request(A, RIGHT, f64::from(t)), Grant::Waiting(LEFT));
        }
        assert!(!b.clear(A, LEFT, AccessClass::Programmer, 1000.0));
        assert!(b.clear(A, LEFT, AccessClass::Integrator, 1000.0));
        assert_eq!(b.request(A, RIGHT, 1000.0), Grant::Held);
    }

    #[test]
    fn a_robot_that_falls_silent_is_unknown_until_it_speaks_or_is_cleared() {
        let b = board();
        b.publish(A, RIGHT, Stay::Warning, 5.0);
        assert_eq!(b.request(A, RIGHT, 5.0), Grant::Unknown(LEFT));
        b.publish(A, LEFT, Stay::Outside, 5.0);
        assert_eq!(b.request(A, RIGHT, 5.05), Grant::Held);
        b.publish(A, RIGHT, Stay::Outside, 6.0);
        b.publish(A, RIGHT, Stay::Warning, 9.0);
        assert_eq!(b.request(A, RIGHT, 9.0), Grant::Unknown(LEFT));
        assert!(b.clear(A, LEFT, AccessClass::Integrator, 9.0));
        assert_eq!(b.request(A, RIGHT, 12.0), Grant::Held);
    }

    #[test]
    fn a_circle_of_robots_in_warning_zones_is_opened_by_one_that_yields() {
        let b = board();
        for (slot, robot) in [(A, LEFT), (B, RIGHT)] {
            b.publish(slot, robot, Stay::Warning, 0.0);
            assert_eq!(b.request(slot, robot, 0.0), Grant::Held);
        }
        b.publish(B, LEFT, Stay::Warning, 0.0);
        b.publish(A, RIGHT, Stay::Warning, 0.0);
        b.request(B, LEFT, 0.0);
        b.request(A, RIGHT, 0.0);
        b.request(B, LEFT, 0.0);
        assert_eq!(b.request(A, RIGHT, 0.0), Grant::Held, "left yields, right goes on");
    }

    #[test]
    fn a_circle_of_robots_inside_is_reported() {
        let b = board();
        for (slot, robot) in [(A, LEFT), (B, RIGHT)] {
            b.publish(slot, robot, Stay::Inside, 0.0);
            assert_eq!(b.request(slot, robot, 0.0), Grant::Held);
        }
        b.publish(B, LEFT, Stay::Warning, 0.0);
        b.publish(A, RIGHT, Stay::Warning, 0.0);
        b.request(B, LEFT, 0.0);
        assert_eq!(b.request(A, RIGHT, 0.0), Grant::Deadlock);
    }

    #[test]
    fn threads_racing_for_a_slot_are_never_both_inside() {
        let board = Arc::new(board());
        let inside = Arc::new(AtomicUsize::new(0));
        let run = |robot: RobotSlot| {
            let (board, inside) = (board.clone(), inside.clone());
            std::thread::spawn(move || {
                let mut entered = 0;
                while entered < 2000 {
                    board.publish(A, robot, Stay::Warning, 0.0);
                    if board.request(A, robot, 0.0) == Grant::Held {
                        board.publish(A, robot, Stay::Inside, 0.0);
                        assert_eq!(inside.fetch_add(1, SeqCst), 0);
                        std::hint::spin_loop();
                        inside.fetch_sub(1, SeqCst);
                        entered += 1;
                        board.publish(A, robot, Stay::Outside, 0.0);
                    } else {
                        std::thread::yield_now();
                    }
                }
            })
        };
        let threads = [run(LEFT), run(RIGHT)];
        for thread in threads {
            thread.join().unwrap();
        }
    }

    #[test]
    fn overlapping_warning_zones_share_a_group() {
        let ball = |x: f64| Region::sphere(format!("{x}"), Vec3::X * x, 0.1).warning(0.2);
        let [a, b, c] = [ball(0.0), ball(0.5), ball(2.0)];
        assert_eq!(group_overlapping(&[&a, &c, &b]), [0, 1, 0]);
    }
}
