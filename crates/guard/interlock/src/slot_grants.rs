//! Grants that come from outside the process, for example from an arbiter on a network.

use std::sync::atomic::{AtomicBool, AtomicU8, Ordering::SeqCst};

use crate::{ExchangeState, Occupancy, SlotId};

/// A robot's grants and its monitor's observations, per slot.
///
/// Before each tick the caller writes the grants of that moment; after the tick it reads what the tick found and
/// passes it on. A tick with invalid input finds nothing: then the values are those of the last valid tick.
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
    /// Creates the state for this number of slots, without grants.
    pub fn new(slots: usize) -> Self {
        Self { slots: (0..slots).map(|_| SlotEntry::default()).collect() }
    }

    /// Number of slots.
    pub fn slots(&self) -> usize {
        self.slots.len()
    }

    /// Writes the grants for the next tick: whether the robot may enter the slot's regions, and whether it must halt
    /// because another robot was found inside.
    pub fn write(&self, slot: SlotId, may_enter: bool, must_halt: bool) {
        self.slots[slot.0].may_enter.store(may_enter, SeqCst);
        self.slots[slot.0].must_halt.store(must_halt, SeqCst);
    }

    /// The robot's occupancy in the last valid tick. `Unknown` before the first valid tick, for a slot without a region
    /// in the configuration, and while the source that a region follows is lost.
    pub fn occupancy(&self, slot: SlotId) -> Occupancy {
        Occupancy::from_u8(self.slots[slot.0].occupancy.load(SeqCst))
    }

    /// State of the robot in the last valid tick.
    pub fn state(&self, slot: SlotId) -> ExchangeState {
        ExchangeState::from_u8(self.slots[slot.0].state.load(SeqCst))
    }

    /// True if the robot needs the slot: in the last valid tick it was in or near an active region of the slot.
    pub fn is_needed(&self, slot: SlotId) -> bool {
        self.slots[slot.0].is_near_active_region.load(SeqCst)
    }

    /// The last value written with [`SlotGrants::write`]: whether the robot may enter the slot's regions.
    pub fn may_enter(&self, slot: SlotId) -> bool {
        self.slots[slot.0].may_enter.load(SeqCst)
    }

    /// The last value written with [`SlotGrants::write`]: whether the robot must halt.
    pub fn must_halt(&self, slot: SlotId) -> bool {
        self.slots[slot.0].must_halt.load(SeqCst)
    }

    /// Writes the findings of a tick of the monitor.
    pub fn found(&self, slot: SlotId, occupancy: Occupancy, state: ExchangeState, is_near_active_region: bool) {
        let entry = &self.slots[slot.0];
        entry.occupancy.store(occupancy as u8, SeqCst);
        entry.state.store(state as u8, SeqCst);
        entry.is_near_active_region.store(is_near_active_region, SeqCst);
    }
}
