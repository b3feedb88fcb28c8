//! Grants that come from outside of the process, such as those of an arbiter on a network.

use std::sync::atomic::{AtomicBool, AtomicU8, Ordering::SeqCst};

use crate::{ExchangeState, Occupancy, SlotId};

/// What a robot is granted, and what its monitor found, per slot. Before each tick the caller writes what is granted at that
/// moment; after it, it reads what the tick found and passes it on. In a tick with invalid input nothing is found: what is
/// read then is that of the last valid tick.
///
/// ```
/// use elbowroom_interlock::{ExchangeState, Occupancy, SlotGrants, SlotId};
/// let (grants, table) = (SlotGrants::new(1), SlotId(0));
/// assert_eq!((grants.occupancy(table), grants.may_enter(table)), (Occupancy::Unknown, false));
/// grants.write(table, true, false); // the caller, before the tick
/// assert!(grants.may_enter(table)); // the monitor, in the tick
/// grants.found(table, Occupancy::Warning, ExchangeState::Granted, true);
/// assert_eq!(grants.state(table), ExchangeState::Granted); // the caller, after the tick
/// ```
#[derive(Debug)]
pub struct SlotGrants {
    slots: Box<[SlotEntry]>,
}

#[derive(Debug, Default)]
struct SlotEntry {
    may_enter: AtomicBool,
    must_halt: AtomicBool,
    occupancy: AtomicU8,
    state: AtomicU8,
    is_near_active_region: AtomicBool,
}

impl SlotGrants {
    /// Grants of nothing, for this number of slots.
    pub fn new(slots: usize) -> Self {
        Self { slots: (0..slots).map(|_| SlotEntry::default()).collect() }
    }

    /// Number of slots.
    pub fn slots(&self) -> usize {
        self.slots.len()
    }

    /// Writes what is granted for the next tick: whether the robot may enter the slot's regions, and whether it must halt because
    /// another one was found inside.
    pub fn write(&self, slot: SlotId, may_enter: bool, must_halt: bool) {
        self.slots[slot.0].may_enter.store(may_enter, SeqCst);
        self.slots[slot.0].must_halt.store(must_halt, SeqCst);
    }

    /// Where the last valid tick found the robot. `Unknown` before the first one, of a slot of which the configuration has no
    /// region, and while the source that a region follows is lost.
    pub fn occupancy(&self, slot: SlotId) -> Occupancy {
        Occupancy::from_u8(self.slots[slot.0].occupancy.load(SeqCst))
    }

    /// State of the robot in the last valid tick.
    pub fn state(&self, slot: SlotId) -> ExchangeState {
        ExchangeState::from_u8(self.slots[slot.0].state.load(SeqCst))
    }

    /// True if the robot needs the slot: in the last valid tick it was in or near a region of it that is switched on.
    pub fn is_needed(&self, slot: SlotId) -> bool {
        self.slots[slot.0].is_near_active_region.load(SeqCst)
    }

    /// What [`SlotGrants::write`] wrote last: the robot may enter the slot's regions.
    pub fn may_enter(&self, slot: SlotId) -> bool {
        self.slots[slot.0].may_enter.load(SeqCst)
    }

    /// What [`SlotGrants::write`] wrote last: the robot must halt.
    pub fn must_halt(&self, slot: SlotId) -> bool {
        self.slots[slot.0].must_halt.load(SeqCst)
    }

    /// Writes what a tick of the monitor found.
    pub fn found(&self, slot: SlotId, occupancy: Occupancy, state: ExchangeState, is_near_active_region: bool) {
        let entry = &self.slots[slot.0];
        entry.occupancy.store(occupancy as u8, SeqCst);
        entry.state.store(state as u8, SeqCst);
        entry.is_near_active_region.store(is_near_active_region, SeqCst);
    }
}
