//! The regions of one robot as they are now, for questions.

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_monitor::{AccessClass, Monitor, RegionId, SourceState};
use elbowroom_sim::replanning::ClosedRegions;

use crate::messages::AttachedVolume;
use crate::node::AttachedVolumes;

/// The regions of one robot. Its monitor never ticks.
pub(super) struct RobotRegions {
    pub setup: MonitorSetup,
    monitor: Monitor,
    attached: AttachedVolumes,
}

impl RobotRegions {
    pub fn new(setup: MonitorSetup, monitor: Monitor) -> Self {
        let attached = AttachedVolumes::new(&setup.configuration);
        Self { setup, monitor, attached }
    }

    /// Takes over which regions are on, and what the robot carries.
    pub fn update(&mut self, active: &[bool], attached: &[AttachedVolume]) {
        for (region, active) in active.iter().enumerate() {
            // Of a permanent region it is refused, which leaves it on.
            let _ = self.monitor.switch(RegionId(region), *active, AccessClass::Programmer);
        }
        self.attached.apply(attached, &mut self.monitor, |_, _| ());
    }

    /// The regions that are closed to the robot, with the sources at their poses.
    pub fn closed(&self, sources: Vec<SourceState>) -> ClosedRegions<'_> {
        ClosedRegions { monitor: &self.monitor, sources }
    }
}
