//! Grants that come from outside of the process, such as those of an arbiter on a network.

use std::sync::atomic::{AtomicBool, AtomicU8, Ordering::SeqCst};

use super::exchange_state::ExchangeState;
use super::occupancy::Occupancy;
use super::slot::SlotId;

/// What a robot is granted, and what its monitor found, per slot. Before each tick the caller writes what is granted at that
/// moment; after it, it reads what the tick found and passes it on. In a tick with invalid input nothing is found: what is
/// read then is that of the last valid tick.
///
/// ```
/// use std::sync::Arc;
/// use elbowroom_monitor::{ExchangeState, Occupancy, SlotGrants, SlotId};
/// # use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
/// # use elbowroom_monitor::{Configuration, ConfigurationParts, Guards, Interlock, Laws, Monitor, Region, RegionKind, Snapshot, Volume};
/// # use elbowroom_monitor::StoppingSettings;
/// # use elbowroom_spatial::{Pose, Vec3};
/// # let rail = Joint { name: "rail".into(), kind: JointKind::Prismatic, parent: LinkId(0), child: LinkId(1),
/// #     origin: Pose::IDENTITY, axis: Vec3::X, limits: Limits::range(0.0, 2.0), mimic: None };
/// # let chain = Chain::new("rail", vec!["base".into(), "carriage".into()], vec![rail])?;
/// # let kind = RegionKind::Exchange { slot: SlotId(0) };
/// # let table = Region::sphere("table", Vec3::X * 2.0, 0.5).warning(0.4).guards(Guards::TCP).kind(kind);
/// # let stopping = StoppingSettings { reaction_s: 0.01, period_s: 0.002, joint_deceleration: vec![5.0],
/// #     joint_acceleration: vec![5.0] };
/// # let configuration = Configuration::new(ConfigurationParts { robot: "rail".into(), base_in_world: Pose::IDENTITY, chain,
/// #     volumes: vec![Volume::tcp(LinkId(1), Vec3::ZERO)], regions: vec![table], sources: vec![],
/// #     laws: Laws { stopping_distance: Some(stopping), ..Laws::default() } })?;
/// let grants = Arc::new(SlotGrants::new(1));
/// let mut monitor = Monitor::new(configuration, Some(Interlock::Granted(grants.clone())))?;
/// let snapshot = |now_s| Snapshot { qd: &[0.0], ..Snapshot::stationary(now_s, &[1.4]) };
/// // In the warning zone of the exchange region `table`, 0.1 m before its border.
/// assert!((monitor.tick(&snapshot(0.0)).speed_override - 0.25).abs() < 1e-12);
/// assert_eq!(grants.occupancy(SlotId(0)), Occupancy::Warning);
/// grants.write(SlotId(0), true, false);
/// assert_eq!(monitor.tick(&snapshot(0.002)).speed_override, 1.0);
/// assert_eq!(grants.state(SlotId(0)), ExchangeState::Granted);
/// # Ok::<(), Box<dyn std::error::Error>>(())
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

    /// True where the robot needs the slot: in the last valid tick it was in or near a region of it that is switched on.
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

    /// What a tick found.
    pub(crate) fn found(&self, slot: SlotId, occupancy: Occupancy, state: ExchangeState, is_near_active_region: bool) {
        let entry = &self.slots[slot.0];
        entry.occupancy.store(occupancy as u8, SeqCst);
        entry.state.store(state as u8, SeqCst);
        entry.is_near_active_region.store(is_near_active_region, SeqCst);
    }
}
