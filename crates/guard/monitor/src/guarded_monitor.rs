//! A monitor whose exchange regions are granted by an arbiter on the network.

use std::sync::Arc;

use elbowroom_interlock::frame::MessageError;
use elbowroom_interlock::{GrantsMessage, Guard, Ignored, Micros, StateMessage, wire};
use thiserror::Error;

use crate::{ConfigError, Configuration, Interlock, Monitor, RegionId, SlotGrants, SlotId, Snapshot, TickReport};

/// Without a valid tick for this long, the robot's position is unknown: somebody may move it by hand.
const UNSEEN: Micros = Micros(100_000);

/// Why a message from the network was not obeyed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum NotObeyed {
    /// The bytes are not a message of an arbiter.
    #[error(transparent)]
    Wire(#[from] MessageError),
    /// The guard ignores the message.
    #[error(transparent)]
    Ignored(#[from] Ignored),
}

/// The monitor of a robot and its guard. Each tick first asks the guard which exchange regions the robot may enter,
/// and then reports to the guard where the robot is. Never allocates after construction.
///
/// All times are read from one monotonic clock of this process.
///
/// ```
/// use elbowroom_interlock::{Boot, Guard, Micros};
/// use elbowroom_monitor::GuardedMonitor;
/// # use elbowroom_kinematics::{Chain, Joint, JointKind, Limits, LinkId};
/// # use elbowroom_monitor::{Configuration, ConfigurationParts, Guards, Laws, Region, RegionKind, Volume};
/// # use elbowroom_monitor::{ExchangeState, RobotSlot, SlotId, Snapshot, StoppingSettings};
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
/// #     grids: vec![],
/// #     laws: Laws { stopping_distance: Some(stopping), ..Laws::default() } })?;
/// # let checksum = 0;
/// let mut robot = GuardedMonitor::new(configuration, Guard::new(RobotSlot(0), 1, checksum, Boot(1)))?;
/// let report = robot.tick(&Snapshot { qd: &[0.0], ..Snapshot::stationary(0.0, &[1.4]) }, Micros(0));
/// assert!(report.speed_override < 1.0); // waiting for the exchange region
/// let bytes = robot.state(Micros(0));   // every 10 ms, to the arbiter; its answers go to `robot.receive`
/// # assert!(!bytes.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct GuardedMonitor {
    monitor: Monitor,
    guard: Guard,
    grants: Arc<SlotGrants>,
    /// Time of the last valid tick.
    seen: Option<Micros>,
    message: StateMessage,
    answer: GrantsMessage,
    bytes: Vec<u8>,
}

impl GuardedMonitor {
    /// Creates a monitor that obeys this guard.
    ///
    /// # Errors
    /// As for [`Monitor::new`]: the guard has fewer slots than the regions need, or the stopping-distance law is off.
    pub fn new(configuration: Configuration, guard: Guard) -> Result<Self, ConfigError> {
        let slots = guard.slots();
        let grants = Arc::new(SlotGrants::new(slots));
        Ok(Self {
            monitor: Monitor::new(configuration, Some(Interlock::Granted(grants.clone())))?,
            guard,
            grants,
            seen: None,
            message: StateMessage::with_slots(slots),
            answer: GrantsMessage::with_slots(slots),
            bytes: Vec::with_capacity(wire::MAX_BYTES),
        })
    }

    /// One tick of the monitor at `now`.
    pub fn tick(&mut self, snapshot: &Snapshot<'_>, now: Micros) -> TickReport {
        for slot in (0..self.guard.slots()).map(SlotId) {
            self.grants.write(slot, self.guard.may_enter(slot, now), self.guard.must_halt(slot));
        }
        let report = self.monitor.tick(snapshot);
        // A tick with invalid input has no observation: an older one must not count as made after a grant was closed.
        if self.monitor.input_fault().is_none() {
            self.seen = Some(now);
            for slot in (0..self.guard.slots()).map(SlotId) {
                self.guard.need(slot, self.grants.is_needed(slot));
                self.guard.observe(slot, self.grants.occupancy(slot));
            }
        }
        report
    }

    /// Encodes the next message to the arbiter, to be sent at `now`: every 10 ms, and at once if a tick changed
    /// [`GuardedMonitor::grants`].
    pub fn state(&mut self, now: Micros) -> &[u8] {
        if self.seen.is_none_or(|seen| now - seen > UNSEEN) {
            self.guard.lose_sight();
        }
        self.guard.state_into(now, &mut self.message);
        // A cell has at most `MAX_SLOTS` slots; a longer message would be empty, and the arbiter would receive nothing.
        if !wire::encode_state(&self.message, &mut self.bytes) {
            self.bytes.clear();
        }
        &self.bytes
    }

    /// Passes a message of the arbiter to the guard.
    ///
    /// # Errors
    /// [`NotObeyed`] states why the message is not obeyed; then nothing changes.
    pub fn receive(&mut self, bytes: &[u8]) -> Result<(), NotObeyed> {
        wire::decode_grants(bytes, &mut self.answer)?;
        Ok(self.guard.receive(&self.answer)?)
    }

    /// What the guard granted in the last tick, and where that tick found the robot.
    pub fn grants(&self) -> &SlotGrants {
        &self.grants
    }

    /// The guard.
    pub fn guard(&self) -> &Guard {
        &self.guard
    }

    /// The monitor.
    pub fn monitor(&self) -> &Monitor {
        &self.monitor
    }

    /// The interlock for another monitor of this robot and this guard, for use with [`GuardedMonitor::replace`].
    pub fn interlock(&self) -> Interlock {
        Interlock::Granted(self.grants.clone())
    }

    /// Replaces the monitor by `next`, which continues from the present one ([`Monitor::continue_from`]); the guard
    /// stays. Create `next` with [`GuardedMonitor::interlock`] and the same exchange regions. Call it between two ticks.
    /// Never allocates.
    pub fn replace(&mut self, next: &mut Monitor, same: &[Option<RegionId>]) {
        next.continue_from(&mut self.monitor, same);
        std::mem::swap(&mut self.monitor, next);
    }

    /// The monitor, to switch regions and attach volumes. For ticks, use [`GuardedMonitor::tick`].
    pub fn monitor_mut(&mut self) -> &mut Monitor {
        &mut self.monitor
    }
}
