//! Granting so that all can finish: a safe-state test (after E. W. Dijkstra's banker's algorithm) over declared needs.
//!
//! A robot that knows its program declares which slots it may still need before it next keeps none. A slot is granted
//! only if afterwards every robot that could finish before can still finish: in some order each gets all that it
//! declared, while those that finished have given back. Then robots that keep to what they declared never wait for each
//! other in a circle. A robot that declared nothing is taken to need no more than it has: for it, circles are only
//! detected (`circle.rs`).
//!
//! An older request that must wait for this reason is passed by younger ones only as far as that cannot go on for ever:
//! a robot that keeps nothing does not start while an older one waits whose declared needs overlap with its own.

use std::sync::atomic::Ordering::SeqCst;

use super::circle::Robots;
use super::{Board, Grant, Planted, RobotSlot, SlotId};

/// Marks declared claims; slots are the bits below.
pub(super) const DECLARED: u64 = 1 << 63;

impl Board {
    /// Declares all slots that a robot may need from now on until it next keeps none of them: those of a stretch of its
    /// program in which it goes from one to the next without leaving them all. Declare the rest of the stretch, or the
    /// next one, as the program goes on; while a slot is kept, a declaration may only shrink.
    ///
    /// The declaration counts on boards of at most 63 slots and 128 robots.
    ///
    /// ```
    /// use elbowroom_monitor::{Board, Grant, RobotSlot, SlotId, Stay};
    /// let board = Board::new(&["left", "right"], &["a", "b"]);
    /// let ([left, right], [a, b]) = ([RobotSlot(0), RobotSlot(1)], [SlotId(0), SlotId(1)]);
    /// for (slot, robot) in [(a, left), (a, right), (b, left), (b, right)] {
    ///     board.publish(slot, robot, Stay::Outside, 0.0);
    /// }
    /// board.declare(left, [a, b]);
    /// board.declare(right, [a, b]);
    /// board.publish(a, left, Stay::Warning, 0.0);
    /// board.publish(b, right, Stay::Warning, 0.0);
    /// assert_eq!(board.request(a, left, 0.0), Grant::Held);
    /// // Each would hold what the other needs next.
    /// assert_eq!(board.request(b, right, 0.0), Grant::Waiting(left));
    /// ```
    pub fn declare(&self, robot: RobotSlot, slots: impl IntoIterator<Item = SlotId>) {
        let fits = self.slots.len() < 64 && self.robots.len() <= Robots::MOST;
        let bits = slots.into_iter().filter(|s| s.0 < 63).fold(0, |bits, s| bits | 1 << s.0);
        self.robots[robot.0].claims.store(if fits { bits | DECLARED } else { 0 }, SeqCst);
    }

    /// Takes back what a robot declared: it leaves its program, and what it will need is not known.
    pub fn undeclare(&self, robot: RobotSlot) {
        self.robots[robot.0].claims.store(0, SeqCst);
    }

    /// The robot that comes before `robot` at a slot that nobody occupies.
    pub(super) fn turn(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Option<RobotSlot> {
        let mine = self.ticket(slot, robot);
        let Some(order) = Order::of(self, now_s) else {
            return self.others(slot, robot).find(|o| (1..mine).contains(&self.ticket(slot, *o)));
        };
        if !order.allows(slot, robot) {
            return order.in_the_way(slot, robot);
        }
        if let Some(older) = order.older_waiting(slot, robot, mine) {
            return Some(older);
        }
        self.others(slot, robot).find(|other| {
            let theirs = self.ticket(slot, *other);
            // One that may not take it now does not keep others from it.
            let may_take = || order.allows(slot, *other) && order.older_waiting(slot, *other, theirs).is_none();
            (1..mine).contains(&theirs) && (may_take() || self.has(Planted::StrictQueue))
        })
    }

    /// After a slot was taken: two robots may have taken one each at the same moment, which each alone could.
    pub(super) fn breaks_order(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> Option<Grant> {
        let order = Order::of(self, now_s)?;
        let mut without = order;
        without.kept[robot.0] &= !(1 << slot.0);
        if without.allows(slot, robot) { None } else { without.in_the_way(slot, robot).map(Grant::Waiting) }
    }
}

/// Who keeps what and may still need what, at one moment.
struct Order<'b> {
    board: &'b Board,
    now_s: f64,
    /// Per robot the slots that it keeps others out of.
    kept: [u64; Robots::MOST],
    /// Per robot the slots that it may still need.
    claims: [u64; Robots::MOST],
    /// Robots of which nothing is known: what they keep stays kept.
    silent: Robots,
}

impl<'b> Order<'b> {
    /// `None` where nobody declared anything.
    fn of(board: &'b Board, now_s: f64) -> Option<Self> {
        if board.robots.iter().all(|r| r.claims.load(SeqCst) == 0) || board.has(Planted::NoOrder) {
            return None;
        }
        let mut order =
            Self { board, now_s, kept: [0; Robots::MOST], claims: [0; Robots::MOST], silent: Robots::default() };
        for (i, member) in board.robots.iter().enumerate().take(Robots::MOST) {
            let robot = RobotSlot(i);
            order.claims[i] = member.claims.load(SeqCst) & !DECLARED;
            for slot in board.all_slots().take(63) {
                if board.holder(slot) == Some(robot) || board.stay(slot, robot).occupies() {
                    order.kept[i] |= 1 << slot.0;
                    if board.is_silent(slot, robot, now_s) {
                        order.silent.insert(robot);
                    }
                }
            }
        }
        Some(order)
    }

    fn robots(&self) -> impl Iterator<Item = RobotSlot> + use<> {
        (0..self.board.robots.len().min(Robots::MOST)).map(RobotSlot)
    }

    /// The robots that can get all they need in some order if `robot` also keeps the slots `more`.
    fn finishing(&self, robot: RobotSlot, more: u64) -> Robots {
        let kept = |r: RobotSlot| if r == robot { self.kept[r.0] | more } else { self.kept[r.0] };
        let mut done = Robots::default();
        loop {
            let taken = |me: RobotSlot, done: Robots| {
                self.robots().filter(|o| *o != me && !done.contains(*o)).fold(0, |bits, o| bits | kept(o))
            };
            let able = |r: &RobotSlot| {
                !done.contains(*r) && !self.silent.contains(*r) && self.claims[r.0] & !kept(*r) & taken(*r, done) == 0
            };
            let Some(next) = self.robots().find(able) else { return done };
            done.insert(next);
        }
    }

    /// True where giving the slot to the robot leaves everybody able to finish who is so now.
    fn allows(&self, slot: SlotId, robot: RobotSlot) -> bool {
        let before = self.finishing(robot, 0);
        let keeps = self.kept[robot.0] != 0;
        if !before.contains(robot) {
            // Its declared needs cannot all be met as things are. If it keeps nothing, it waits; otherwise no order of
            // granting helps, and it may need less than it declared.
            return keeps;
        }
        let after = self.finishing(robot, 1 << slot.0);
        before.0 & !after.0 == 0
    }

    /// Somebody who keeps something that the robot needs, or anything.
    fn in_the_way(&self, slot: SlotId, robot: RobotSlot) -> Option<RobotSlot> {
        let needs = self.claims[robot.0] | 1 << slot.0;
        let others = || self.robots().filter(|o| *o != robot);
        let keeps = |bits: u64| others().find(move |o| self.kept[o.0] & bits != 0);
        keeps(needs).or_else(|| keeps(u64::MAX))
    }

    /// An older request that waits only for the order, where the robot starts anew and what both need overlaps.
    fn older_waiting(&self, slot: SlotId, robot: RobotSlot, ticket: u64) -> Option<RobotSlot> {
        if self.kept[robot.0] != 0 {
            return None;
        }
        let board = self.board;
        let needs = self.claims[robot.0] | 1 << slot.0;
        let waits = |other: &RobotSlot| {
            board.all_slots().any(|s| {
                let theirs = board.ticket(s, *other);
                (1..ticket).contains(&theirs)
                    && !board.is_silent(s, *other, self.now_s)
                    && (self.claims[other.0] | 1 << s.0) & needs != 0
                    && board.holder(s).is_none()
                    && self.finishing(*other, 0).contains(*other)
                    && !self.allows(s, *other)
            })
        };
        self.robots().filter(|o| *o != robot).find(waits)
    }
}
