//! Data of the next tick of a monitor.

use elbowroom_monitor::{Monitor, RegionId, Snapshot, TickReport, VolumeId};
use elbowroom_ros2::msgs::elbowroom_msgs::{MonitorTick, RegionSwitch, VolumeAttachment};
use elbowroom_spatial::Pose;

use crate::{solid, tick};

/// Collects the changes of a monitor between two ticks, and numbers the ticks.
#[derive(Debug, Default)]
pub(crate) struct TickWriter {
    robot: u32,
    sequence: u64,
    switched: Vec<RegionSwitch>,
    attached: Vec<VolumeAttachment>,
    forgot_position: bool,
}

impl TickWriter {
    pub(crate) fn new(robot: u32) -> Self {
        Self { robot, ..Self::default() }
    }

    pub(crate) fn switched(&mut self, region: RegionId, active: bool) {
        self.switched.push(RegionSwitch { region: index(region.0), active });
    }

    pub(crate) fn attached(&mut self, volume: VolumeId, in_link: &Pose) {
        let in_link = solid::pose_values(in_link);
        self.attached.push(VolumeAttachment { volume: index(volume.0), attached: true, in_link });
    }

    pub(crate) fn detached(&mut self, volume: VolumeId) {
        let in_link = solid::pose_values(&Pose::IDENTITY);
        self.attached.push(VolumeAttachment { volume: index(volume.0), attached: false, in_link });
    }

    pub(crate) fn forgot_position(&mut self) {
        self.forgot_position = true;
    }

    /// Writes the tick into a message.
    pub(crate) fn write(
        &mut self,
        to: &mut MonitorTick,
        t_s: f64,
        snapshot: &Snapshot<'_>,
        report: &TickReport,
        monitor: &Monitor,
    ) {
        tick::write(to, self.robot, snapshot, report, monitor);
        to.t_s = t_s;
        to.sequence = self.sequence;
        to.forgot_position = std::mem::take(&mut self.forgot_position);
        to.switched.clear();
        to.switched.append(&mut self.switched);
        to.attached.clear();
        to.attached.append(&mut self.attached);
        self.sequence += 1;
    }

    /// Skips a tick that is not recorded: its number is then missing, and the replay ends there.
    ///
    /// Its changes are dropped too, so that nothing grows while a file does not respond.
    pub(crate) fn skip(&mut self) {
        self.switched.clear();
        self.attached.clear();
        self.forgot_position = false;
        self.sequence += 1;
    }
}

fn index(index: usize) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX)
}
