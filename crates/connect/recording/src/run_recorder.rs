//! Recorder of a simulated run.

use std::io::{Seek, Write};

use elbowroom_cell::Cell;
use elbowroom_monitor::{RegionId, RobotSlot, SlotId, VolumeId, ZoneArbiter};
use elbowroom_robot::RobotId;
use elbowroom_ros2::msgs::elbowroom_msgs::MonitorTick;
use elbowroom_sim::run::{ObservedInstant, ObservedTick, RunObserver};
use elbowroom_spatial::Pose;
use elbowroom_status::{CellStatus, EventStatus, PlacedStatus, RobotStatus, SlotStatus};

use crate::tick_writer::TickWriter;
use crate::{BagError, CellWriter};

/// Time between two statuses, s.
const STATUS_S: f64 = 0.02;

/// Records a run as its observer: [`simulate_observed`](elbowroom_sim::run::simulate_observed).
///
/// Nothing is omitted; the run waits for the file.
pub struct RunRecorder<W: Write + Seek> {
    writer: CellWriter<W>,
    robots: Vec<TickWriter>,
    /// Whether the configuration of each robot is in the file.
    is_configured: Vec<bool>,
    tick: MonitorTick,
    status: CellStatus,
    next_status_s: f64,
    /// The first error; nothing is written after it.
    error: Option<BagError>,
}

impl<W: Write + Seek> RunRecorder<W> {
    /// Creates a recorder that uses this writer.
    pub fn new(writer: CellWriter<W>, cell: &Cell) -> Self {
        Self {
            writer,
            robots: (0..).map(TickWriter::new).take(cell.robots.len()).collect(),
            is_configured: vec![false; cell.robots.len()],
            tick: MonitorTick::default(),
            status: CellStatus {
                cell: cell.name.clone(),
                checksum: cell.approval.checksum.clone(),
                ..CellStatus::default()
            },
            next_status_s: 0.0,
            error: None,
        }
    }

    /// Completes the file.
    ///
    /// # Errors
    /// The first error of the recording.
    pub fn finish(self) -> Result<(), BagError> {
        match self.error {
            Some(error) => Err(error),
            None => self.writer.finish(),
        }
    }

    fn attempt(&mut self, write: impl FnOnce(&mut Self) -> Result<(), BagError>) {
        if self.error.is_none() {
            self.error = write(self).err();
        }
    }

    fn record_tick(&mut self, tick: &ObservedTick<'_>) -> Result<(), BagError> {
        let robot = tick.robot.0;
        let now_s = tick.snapshot.now_s;
        if !std::mem::replace(&mut self.is_configured[robot], true) {
            let index = u32::try_from(robot).unwrap_or(u32::MAX);
            self.writer.configuration(index, tick.monitor, now_s)?;
        }
        self.robots[robot].write(&mut self.tick, now_s, tick.snapshot, tick.report, tick.monitor);
        if now_s >= self.next_status_s {
            let present = tick.present;
            let tcp_in_root = tick.monitor.state().link_in_root(present.flange) * present.tcp_in_flange;
            // A mechanism has none.
            let tcp = tick.monitor.tcp().map(|_| present.base_in_world * tcp_in_root);
            let status = RobotStatus::of_tick(now_s, tick.monitor, tick.snapshot, tick.report, tcp.as_ref());
            self.status.robots.push(RobotStatus { sequence: self.tick.sequence, ..status });
        }
        self.writer.tick(&self.tick)
    }

    fn record_instant(&mut self, instant: &ObservedInstant<'_>) -> Result<(), BagError> {
        let events = instant.events.iter().map(|e| EventStatus {
            t_s: e.t_s,
            robot: e.robot.clone(),
            region: e.region.clone(),
            event: e.event.name().to_owned(),
        });
        self.status.events.extend(events);
        if instant.t_s < self.next_status_s {
            return Ok(());
        }
        self.next_status_s = instant.t_s + STATUS_S;
        self.status.t_s = instant.t_s;
        let placed = instant.objects.iter().filter_map(|o| {
            let pose = o.poses.last()?.into();
            Some(PlacedStatus { name: o.name.clone(), pose })
        });
        self.status.objects = placed.collect();
        self.status.slots = instant.arbiter.map_or_else(Vec::new, |arbiter| slots(arbiter, &self.status));
        let result = self.writer.status(&self.status);
        self.status.robots.clear();
        self.status.events.clear();
        result
    }
}

/// Returns the holders of the slots, and the robots that wait, in the order of the cell.
fn slots(arbiter: &ZoneArbiter, status: &CellStatus) -> Vec<SlotStatus> {
    let of_slot = |slot: SlotId| {
        let regions: Vec<String> = arbiter.slot_name(slot).split(", ").map(str::to_owned).collect();
        let waits =
            |robot: &&RobotStatus| regions.iter().any(|r| robot.exchange.get(r).is_some_and(|s| s == "waiting"));
        let queue = status.robots.iter().filter(waits).map(|robot| robot.robot.clone()).collect();
        let holder = arbiter.holder(slot).map(|robot: RobotSlot| arbiter.robot_name(robot).to_owned());
        SlotStatus { regions, holder, queue, age_s: 0.0 }
    };
    (0..arbiter.slots()).map(SlotId).map(of_slot).collect()
}

impl<W: Write + Seek> RunObserver for RunRecorder<W> {
    fn switched(&mut self, robot: RobotId, region: RegionId, active: bool) {
        self.robots[robot.0].switched(region, active);
    }

    fn attached(&mut self, robot: RobotId, volume: VolumeId, in_link: &Pose) {
        self.robots[robot.0].attached(volume, in_link);
    }

    fn detached(&mut self, robot: RobotId, volume: VolumeId) {
        self.robots[robot.0].detached(volume);
    }

    fn ticked(&mut self, tick: &ObservedTick<'_>) {
        self.attempt(|recorder| recorder.record_tick(tick));
    }

    fn instant(&mut self, instant: &ObservedInstant<'_>) {
        self.attempt(|recorder| recorder.record_instant(instant));
    }
}
