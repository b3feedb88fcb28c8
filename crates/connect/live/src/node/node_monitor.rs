//! Monitor of a node, with or without exchange regions.

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_interlock::{Boot, Guard, Micros};
use elbowroom_monitor::{
    ConfigError, GuardedMonitor, Interlock, Monitor, Occupancy, RegionId, RegionKind, RobotSlot, SlotId, Snapshot,
    TickReport,
};

/// The monitor of a robot, with a guard if it has exchange regions.
#[derive(Debug)]
pub struct NodeMonitor {
    monitor: Inner,
    /// Last reported occupancy per slot.
    reported: Vec<Occupancy>,
}

#[derive(Debug)]
enum Inner {
    Alone(Box<Monitor>),
    Guarded(Box<GuardedMonitor>),
}

impl NodeMonitor {
    /// Creates the monitor of a setup, in a cell with this number of slots and this configuration.
    ///
    /// `boot` must be higher than at earlier starts of the node.
    ///
    /// # Errors
    /// As for [`GuardedMonitor::new`].
    pub fn new(
        setup: &MonitorSetup,
        robot: RobotSlot,
        slots: usize,
        checksum: u64,
        boot: Boot,
    ) -> Result<Self, ConfigError> {
        let configuration = setup.configuration.clone();
        let is_exchange = |kind: RegionKind| matches!(kind, RegionKind::Exchange { .. });
        if !configuration.regions().iter().any(|r| is_exchange(r.kind)) {
            return Ok(Self {
                monitor: Inner::Alone(Box::new(Monitor::new(configuration, None)?)),
                reported: Vec::new(),
            });
        }
        let guard = Guard::new(robot, slots, checksum, boot);
        let guarded = GuardedMonitor::new(configuration, guard)?;
        Ok(Self { monitor: Inner::Guarded(Box::new(guarded)), reported: vec![Occupancy::Unknown; slots] })
    }

    pub(crate) fn monitor(&self) -> &Monitor {
        match &self.monitor {
            Inner::Alone(monitor) => monitor,
            Inner::Guarded(guarded) => guarded.monitor(),
        }
    }

    pub(super) fn monitor_mut(&mut self) -> &mut Monitor {
        match &mut self.monitor {
            Inner::Alone(monitor) => monitor,
            Inner::Guarded(guarded) => guarded.monitor_mut(),
        }
    }

    /// The interlock for another monitor of this robot; `None` without exchange regions.
    pub(super) fn interlock(&self) -> Option<Interlock> {
        match &self.monitor {
            Inner::Alone(_) => None,
            Inner::Guarded(guarded) => Some(guarded.interlock()),
        }
    }

    /// Exchanges the monitor with one for other regions, which continues from the state of this one.
    pub(super) fn replace(&mut self, next: &mut Monitor, same: &[Option<RegionId>]) {
        match &mut self.monitor {
            Inner::Alone(monitor) => {
                next.continue_from(monitor, same);
                std::mem::swap(&mut **monitor, next);
            }
            Inner::Guarded(guarded) => guarded.replace(next, same),
        }
    }

    pub(super) fn tick(&mut self, snapshot: &Snapshot<'_>, now: Micros) -> TickReport {
        match &mut self.monitor {
            Inner::Alone(monitor) => monitor.tick(snapshot),
            Inner::Guarded(guarded) => guarded.tick(snapshot, now),
        }
    }

    /// Returns the bytes of the next message to the arbiter; empty without exchange regions.
    pub(super) fn state(&mut self, now: Micros) -> &[u8] {
        match &mut self.monitor {
            Inner::Alone(_) => &[],
            Inner::Guarded(guarded) => guarded.state(now),
        }
    }

    /// Passes a message of the arbiter to the guard. A refused message changes nothing.
    pub(super) fn receive(&mut self, bytes: &[u8]) {
        if let Inner::Guarded(guarded) = &mut self.monitor {
            let _ = guarded.receive(bytes);
        }
    }

    /// Whether the robot's occupancy of a slot has changed since the last call.
    pub(super) fn has_news(&mut self) -> bool {
        let Inner::Guarded(guarded) = &self.monitor else { return false };
        let mut has_news = false;
        for (slot, reported) in self.reported.iter_mut().enumerate() {
            let occupancy = guarded.grants().occupancy(SlotId(slot));
            has_news |= *reported != occupancy;
            *reported = occupancy;
        }
        has_news
    }
}
