//! The memory that the robots of a zone arbiter share, and the atomic operations on it.

use std::sync::atomic::{AtomicBool, AtomicU8, AtomicU32, AtomicU64, Ordering::SeqCst};

use crate::{Occupancy, RobotSlot, SlotId};

/// Default time (s) without a publication after which a robot's occupancy is not known.
const DEFAULT_SILENCE_TIMEOUT_S: f64 = 0.1;

/// Locks, published occupancies and queues.
#[derive(Debug)]
pub(super) struct SharedState {
    pub(super) robots: Box<[RobotEntry]>,
    pub(super) slots: Box<[SlotEntry]>,
    pub(super) next_ticket: AtomicU64,
    /// Time (s) without a publication after which a robot's occupancy is not known.
    pub(super) silence_timeout_s: f64,
    #[cfg(test)]
    pub(super) injected_fault: AtomicU8,
}

/// Planted faults of the protocol that the model check must find; never active outside tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum InjectedFault {
    GrantWhileOccupied = 1,
    KeepsStaleOccupancy,
    SilenceIsAbsence,
    YieldsCommitted,
    NoSafeOrder,
    StrictQueue,
    NoSecondCheck,
}

#[derive(Debug)]
pub(super) struct RobotEntry {
    pub(super) name: String,
    /// Bits of the slots that the robot declared, and [`DECLARED`](super::safe_order::DECLARED); 0 if it declared
    /// nothing.
    pub(super) claims: AtomicU64,
}

#[derive(Debug)]
pub(super) struct SlotEntry {
    pub(super) name: String,
    /// Index of the holder plus 1; 0 for none.
    pub(super) holder: AtomicU32,
    pub(super) robots: Box<[RobotAtSlot]>,
}

/// The state of one robot at one slot.
#[derive(Debug, Default)]
pub(super) struct RobotAtSlot {
    pub(super) registered: AtomicBool,
    pub(super) occupancy: AtomicU8,
    /// Bits of the time of the last publication.
    pub(super) published_s: AtomicU64,
    /// Place in the queue; 0 for none.
    pub(super) ticket: AtomicU64,
}

impl SharedState {
    pub(super) fn new(robots: &[&str], slots: &[&str]) -> Self {
        let robot = |name: &&str| RobotEntry { name: (*name).into(), claims: AtomicU64::new(0) };
        let slot = |name: &&str| SlotEntry {
            name: (*name).into(),
            holder: AtomicU32::new(0),
            robots: robots.iter().map(|_| RobotAtSlot::default()).collect(),
        };
        Self {
            robots: robots.iter().map(robot).collect(),
            slots: slots.iter().map(slot).collect(),
            next_ticket: AtomicU64::new(1),
            silence_timeout_s: DEFAULT_SILENCE_TIMEOUT_S,
            #[cfg(test)]
            injected_fault: AtomicU8::new(0),
        }
    }

    pub(super) fn entry(&self, slot: SlotId, robot: RobotSlot) -> &RobotAtSlot {
        &self.slots[slot.0].robots[robot.0]
    }

    pub(super) fn all_slots(&self) -> impl Iterator<Item = SlotId> + use<> {
        (0..self.slots.len()).map(SlotId)
    }

    /// The other robots that are registered at a slot.
    pub(super) fn others(&self, slot: SlotId, robot: RobotSlot) -> impl Iterator<Item = RobotSlot> + '_ {
        let is_registered = move |o: &RobotSlot| *o != robot && self.entry(slot, *o).registered.load(SeqCst);
        (0..self.robots.len()).map(RobotSlot).filter(is_registered)
    }

    pub(super) fn holder(&self, slot: SlotId) -> Option<RobotSlot> {
        let holder = self.slots[slot.0].holder.load(SeqCst);
        (holder > 0).then(|| RobotSlot(holder as usize - 1))
    }

    /// Makes the robot the holder of a slot.
    ///
    /// # Errors
    /// The robot that holds the slot, if another robot does.
    pub(super) fn acquire(&self, slot: SlotId, robot: RobotSlot) -> Result<(), RobotSlot> {
        let me = robot.0 as u32 + 1;
        let acquired = self.slots[slot.0].holder.compare_exchange(0, me, SeqCst, SeqCst);
        acquired.map(|_| ()).map_err(|holder| RobotSlot(holder as usize - 1))
    }

    /// Releases the slot if the robot holds it.
    pub(super) fn release(&self, slot: SlotId, robot: RobotSlot) {
        // Fails if the slot is free or another robot holds it: then there is nothing to release.
        let _ = self.slots[slot.0].holder.compare_exchange(robot.0 as u32 + 1, 0, SeqCst, SeqCst);
    }

    pub(super) fn occupancy(&self, slot: SlotId, robot: RobotSlot) -> Occupancy {
        Occupancy::from_u8(self.entry(slot, robot).occupancy.load(SeqCst))
    }

    /// True if the robot has not published within the silence timeout.
    pub(super) fn is_silent(&self, slot: SlotId, robot: RobotSlot, now_s: f64) -> bool {
        let age_s = now_s - f64::from_bits(self.entry(slot, robot).published_s.load(SeqCst));
        age_s.is_nan() || age_s > self.silence_timeout_s
    }

    pub(super) fn ticket(&self, slot: SlotId, robot: RobotSlot) -> u64 {
        self.entry(slot, robot).ticket.load(SeqCst)
    }

    pub(super) fn join_queue(&self, slot: SlotId, robot: RobotSlot) {
        let entry = self.entry(slot, robot);
        if entry.ticket.load(SeqCst) == 0 {
            entry.ticket.store(self.next_ticket.fetch_add(1, SeqCst), SeqCst);
        }
    }

    pub(super) fn leave_queue(&self, slot: SlotId, robot: RobotSlot) {
        self.entry(slot, robot).ticket.store(0, SeqCst);
    }

    #[cfg(test)]
    pub(super) fn has(&self, fault: InjectedFault) -> bool {
        self.injected_fault.load(SeqCst) == fault as u8
    }

    #[cfg(not(test))]
    #[allow(clippy::unused_self, reason = "used in tests")]
    pub(super) fn has(&self, _: InjectedFault) -> bool {
        false
    }
}
