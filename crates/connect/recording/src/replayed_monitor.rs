//! Monitor that runs again in a replay.

use std::sync::Arc;

use elbowroom_monitor::{
    AccessClass, Configuration, Fault, Interlock, Monitor, Occupancy, RegionId, RegionKind, RobotSlot, SlotGrants,
    SlotId, Snapshot, SourceState, TickReport, VolumeId, ZoneArbiter,
};
use elbowroom_ros2::msgs::elbowroom_msgs::{MonitorConfiguration, MonitorTick};

use crate::replay_result::{Difference, RobotReplay};
use crate::{BagError, ConfigurationDefect, TickDefect, configuration, solid, tick};

/// Most slots of exchange regions.
const MAX_SLOTS: usize = 4096;
/// In the arbiter of a replay, the robot itself; `OTHERS` stands for all other robots.
const SELF: RobotSlot = RobotSlot(0);
const OTHERS: RobotSlot = RobotSlot(1);

/// The monitor of one robot, with the result of its replay so far.
pub(crate) struct ReplayedMonitor {
    monitor: Monitor,
    interlock: Option<Interlock>,
    slots: Vec<SlotId>,
    next: u64,
    found: RobotReplay,
    sources: Vec<SourceState>,
}

impl ReplayedMonitor {
    pub(crate) fn new(message: &MonitorConfiguration) -> Result<Self, BagError> {
        let (monitor, interlock, slots) = built(message)?;
        let found = RobotReplay { name: message.name.clone(), ..RobotReplay::default() };
        Ok(Self { monitor, interlock, slots, next: 0, found, sources: Vec::new() })
    }

    /// Continues with another configuration, as the service did.
    pub(crate) fn configure(&mut self, message: &MonitorConfiguration) -> Result<(), BagError> {
        (self.monitor, self.interlock, self.slots) = built(message)?;
        Ok(())
    }

    pub(crate) fn finish(self) -> RobotReplay {
        self.found
    }

    pub(crate) fn tick(&mut self, tick: &MonitorTick) -> Result<(), BagError> {
        // A monitor has a memory: after a missing tick its answers may differ.
        if self.found.skipped > 0 || tick.sequence != self.next {
            self.found.skipped += 1;
            return Ok(());
        }
        self.next = self.next.wrapping_add(1);
        self.change(tick).map_err(|source| BagError::Tick {
            robot: self.found.name.clone(),
            sequence: tick.sequence,
            source,
        })?;
        self.grant(tick);
        self.sources.clear();
        self.sources.extend(tick.sources.iter().map(tick::source_state));
        let report = self.monitor.tick(&Snapshot {
            now_s: tick.now_s,
            stamp_s: tick.stamp_s,
            q: &tick.q,
            qd: &tick.qd,
            qdd: &tick.qdd,
            programmed_override: tick.programmed_override,
            intent: tick.has_intent.then_some(&tick.intent[..]),
            sources: &self.sources,
        });
        self.compare(tick, &report);
        Ok(())
    }

    /// Applies the changes since the tick before.
    fn change(&mut self, tick: &MonitorTick) -> Result<(), TickDefect> {
        if tick.forgot_position {
            self.monitor.forget_position();
        }
        // The kind of fault does not matter: each has the same effect.
        self.monitor.set_external_fault(tick.has_external_fault.then_some(Fault::Regions));
        for switch in &tick.switched {
            let region = switch.region as usize;
            if region >= self.monitor.configuration().regions().len() {
                return Err(TickDefect::NoRegion(region));
            }
            self.monitor.switch(RegionId(region), switch.active, AccessClass::Integrator)?;
        }
        for change in &tick.attached {
            let volume = VolumeId(change.volume as usize);
            if change.attached {
                let pose = solid::pose_of(&change.in_link).ok_or(TickDefect::Pose)?;
                self.monitor.attach(volume, &pose)?;
            } else {
                self.monitor.detach(volume)?;
            }
        }
        Ok(())
    }

    /// Grants the slots that were granted in the recording.
    fn grant(&self, tick: &MonitorTick) {
        let contains = |slots: &[u32], slot: &SlotId| slots.iter().any(|s| *s as usize == slot.0);
        for slot in &self.slots {
            let is_granted = contains(&tick.granted, slot);
            match &self.interlock {
                Some(Interlock::Granted(grants)) => grants.write(*slot, is_granted, contains(&tick.halted, slot)),
                Some(Interlock::Shared(arbiter, _)) => answer(arbiter, *slot, is_granted, tick.now_s),
                None => {}
            }
        }
    }

    fn compare(&mut self, tick: &MonitorTick, report: &TickReport) {
        self.found.ticks += 1;
        self.found.until_s = tick.t_s;
        let what = if report.speed_override.to_bits() != tick.speed_override.to_bits() {
            "override"
        } else if report.outputs != tick.outputs {
            "outputs"
        } else if tick::reason(report.reason) != (tick.reason, tick.region) {
            "reason"
        } else {
            return;
        };
        self.found.differences += 1;
        self.found.first.get_or_insert(Difference {
            t_s: tick.t_s,
            sequence: tick.sequence,
            what,
            recorded: tick.speed_override,
            replayed: report.speed_override,
        });
    }
}

/// Makes the arbiter answer as recorded: all other robots are outside a slot that the robot was granted, and inside any
/// other slot. The real positions of the other robots do not matter to this monitor.
fn answer(arbiter: &ZoneArbiter, slot: SlotId, is_granted: bool, now_s: f64) {
    if is_granted {
        arbiter.publish(slot, OTHERS, Occupancy::Outside, now_s);
        return;
    }
    if arbiter.holder(slot) == Some(SELF) {
        arbiter.publish(slot, SELF, Occupancy::Outside, now_s);
    }
    arbiter.publish(slot, OTHERS, Occupancy::Inside, now_s);
}

type Built = (Monitor, Option<Interlock>, Vec<SlotId>);

fn built(message: &MonitorConfiguration) -> Result<Built, BagError> {
    build(message).map_err(|source| BagError::Configuration { robot: message.name.clone(), source })
}

fn build(message: &MonitorConfiguration) -> Result<Built, ConfigurationDefect> {
    let configuration = configuration::decode(message)?;
    if configuration.checksum() != message.checksum {
        return Err(ConfigurationDefect::Checksum);
    }
    let slots = slots(&configuration);
    if let Some(slot) = slots.iter().find(|s| s.0 >= MAX_SLOTS) {
        return Err(ConfigurationDefect::Slot { slot: slot.0, limit: MAX_SLOTS });
    }
    let count = slots.iter().map(|s| s.0 + 1).max();
    let interlock = count.map(|count| {
        if message.granted_from_outside {
            return Interlock::Granted(Arc::new(SlotGrants::new(count)));
        }
        // The recorded answers already account for silent robots.
        let arbiter = ZoneArbiter::new(&["self", "others"], &vec!["slot"; count]).silence_timeout(f64::INFINITY);
        Interlock::Shared(Arc::new(arbiter), SELF)
    });
    let monitor = Monitor::new(configuration, interlock.clone())?;
    Ok((monitor, interlock, slots))
}

/// Returns the slots of the exchange regions, each once.
fn slots(configuration: &Configuration) -> Vec<SlotId> {
    let slot = |kind: RegionKind| if let RegionKind::Exchange { slot } = kind { Some(slot) } else { None };
    let mut slots: Vec<SlotId> = configuration.regions().iter().filter_map(|r| slot(r.kind)).collect();
    slots.sort_unstable();
    slots.dedup();
    slots
}
