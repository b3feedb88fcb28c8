//! Tick of a node, without its threads, its network and its clock.

use std::sync::{Arc, MutexGuard};
use std::time::{Duration, Instant};

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, Follow};
use elbowroom_interlock::Micros;
use elbowroom_monitor::TickReport;
use elbowroom_recording::TickRecorder;
use elbowroom_robot::RobotId;
use elbowroom_status::{HealthStatus, StatusSample};

use super::guarded_robot::GuardedRobot;
use super::inbox::{Contents, Inbox};
use super::node_monitor::NodeMonitor;
use super::outbox::Outbox;
use super::region_builder::RegionBuilder;
use crate::cell_versions::CellVersions;
use crate::clock::Clock;
use crate::messages::OverrideAnswer;
use crate::regions_table::RegionTableMessage;

/// Shortest time between two statuses.
const STATUS_PERIOD: Micros = Micros(20_000);
/// Interval at which a guard writes to the arbiter; at once after a change.
const REPORT_PERIOD: Micros = Micros(10_000);

/// Whether the regions of a setup follow a robot.
pub(super) fn follows(setup: &MonitorSetup, robot: RobotId) -> bool {
    setup.sources.iter().any(|s| matches!(s, Follow::Robot { robot: r, .. } if *r == robot))
}

/// The work of a [`Node`](super::Node) between a joint state and its answer, for programs with a loop of their own: put
/// messages in, call [`Self::tick`], take messages out.
///
/// Nothing is allocated after [`Self::new`], except by [`Self::regions`] and by a recorder; `tests/alloc.rs` counts.
pub struct NodeTick {
    guarded: GuardedRobot,
    inbox: Arc<Inbox>,
    outbox: Arc<Outbox>,
    stale: Micros,
    health: HealthStatus,
    /// Time of the last status.
    published: Option<Micros>,
    /// Time of the guard's last message to the arbiter.
    reported: Option<Micros>,
}

impl NodeTick {
    /// Creates the tick of the robot of a setup and its monitor.
    ///
    /// `checksum` is the [`configuration_number`](crate::configuration_number) of the cell.
    pub fn new(
        cell: Arc<Cell>,
        setup: MonitorSetup,
        monitor: NodeMonitor,
        checksum: u64,
        recorder: Option<TickRecorder>,
    ) -> Self {
        let followed = (0..cell.robots.len()).map(|r| follows(&setup, RobotId(r))).collect();
        let (inbox, stale) = (Inbox::new(checksum, followed, &cell), cell.monitoring.laws.stale_s);
        let guarded = GuardedRobot::new(cell, setup, monitor, checksum, recorder);
        Self {
            inbox: Arc::new(inbox),
            outbox: Arc::new(Outbox::new(guarded.monitor(), guarded.version.clone())),
            guarded,
            stale: Micros::from_seconds(stale),
            health: HealthStatus::default(),
            published: None,
            reported: None,
        }
    }

    /// Stops the robot until a table of regions is received: the regions may have changed since the cell file.
    pub fn await_regions(&mut self) {
        self.guarded.awaits_regions = true;
    }

    /// Returns the builder that makes the node's configuration for changed regions.
    ///
    /// Without it the node stops when they are due.
    pub fn region_builder(&self, robot: RobotId, versions: Arc<CellVersions>) -> RegionBuilder {
        let (interlock, version) = (self.guarded.interlock(), self.guarded.version.clone());
        RegionBuilder::new(self.inbox.clone(), versions, robot, interlock, version)
    }

    pub(super) fn inbox(&self) -> &Arc<Inbox> {
        &self.inbox
    }

    pub(super) fn outbox(&self) -> &Arc<Outbox> {
        &self.outbox
    }

    /// Puts in a joint state of the robot. All times are on one monotonic clock of this process.
    pub fn joint_state(&self, bytes: &[u8], arrived: Micros) {
        self.inbox.take_joint_state(bytes, arrived);
    }

    /// Puts in a joint state of another robot; it is used if a region follows that robot.
    pub fn followed_joint_state(&self, robot: RobotId, bytes: &[u8], arrived: Micros) {
        self.inbox.take_followed(robot, bytes, arrived);
    }

    /// Puts in a message of a measured source, by its index in
    /// [`FrameSources::measured`](elbowroom_cell::FrameSources::measured).
    pub fn measured(&self, index: usize, bytes: &[u8], arrived: Micros) {
        self.inbox.take_measured(index, bytes, arrived);
    }

    /// Puts in a message of the arbiter.
    pub fn grants(&self, bytes: &[u8]) {
        self.inbox.take_grants(bytes);
    }

    /// Puts in a table of regions.
    pub fn regions(&self, message: &RegionTableMessage, arrived: Micros) {
        self.inbox.take_regions(message, arrived);
    }

    /// Answers the joint state that arrived last, if it is new; without a new one, ticks if the last one is stale.
    ///
    /// `None` if there was nothing to do.
    pub fn tick(&mut self, now: Micros) -> Option<TickReport> {
        let inbox = self.inbox.clone();
        self.tick_on(inbox.lock(), now)
    }

    /// Takes the answer to the controller, if there is a new one.
    pub fn take_answer(&self) -> Option<OverrideAnswer> {
        self.outbox.lock().answer.take()
    }

    /// Exchanges `bytes` with the message to the arbiter; false if there is no new one.
    pub fn take_interlock_state(&self, bytes: &mut Vec<u8>) -> bool {
        bytes.clear();
        std::mem::swap(bytes, &mut self.outbox.lock().state);
        !bytes.is_empty()
    }

    /// Exchanges `sample` with the data of a status; false if there is no new one. At most fifty per second are made.
    pub fn take_sample(&self, sample: &mut StatusSample) -> bool {
        self.outbox.lock().take_sample(sample).is_some()
    }

    /// Creates an empty sample for [`Self::take_sample`].
    pub fn new_sample(&self) -> StatusSample {
        StatusSample::new(self.guarded.monitor())
    }

    /// Time without joint values after which they are stale.
    pub(super) fn stale(&self) -> Duration {
        Duration::from_micros(self.stale.0)
    }

    /// Waits for joint values and answers them; without any, ticks when the last ones are stale. False at the end.
    pub(super) fn wait_and_tick(&mut self, clock: Clock, longest: Duration) -> bool {
        let inbox = self.inbox.clone();
        let contents = inbox.wait(longest);
        if contents.is_closed {
            return false;
        }
        self.tick_on(contents, clock.micros());
        true
    }

    fn tick_on(&mut self, mut contents: MutexGuard<'_, Contents>, now: Micros) -> Option<TickReport> {
        let began = Instant::now();
        let has_joints = contents.own.is_new;
        self.health.rejected = contents.own.rejected();
        self.guarded.take(&mut contents, now);
        // Input that arrives during the tick is for the next one.
        drop(contents);
        let is_stale = self.guarded.is_stale();
        if !has_joints && !is_stale {
            return None;
        }
        let report = self.guarded.tick(now);
        self.health.ticks += 1;
        self.health.stale += u64::from(is_stale);
        self.health.tick_max_us = self.health.tick_max_us.max(began.elapsed().as_micros() as u64);
        self.put(&report, now);
        Some(report)
    }

    fn put(&mut self, report: &TickReport, now: Micros) {
        let answer = self.guarded.answer(report);
        let is_report_due =
            self.guarded.interlock_has_news() || self.reported.is_none_or(|at| now - at >= REPORT_PERIOD);
        let is_status_due = self.published.is_none_or(|at| now - at >= STATUS_PERIOD);
        let Self { guarded, outbox, reported, .. } = self;
        let mut has_sample = false;
        outbox.put(|outgoing| {
            outgoing.answer = Some(answer);
            if is_report_due {
                outgoing.state.clear();
                outgoing.state.extend_from_slice(guarded.interlock_state(now));
                *reported = Some(now);
            }
            has_sample = outgoing.has_sample;
        });
        // The answer does not wait for the status.
        if is_status_due && !has_sample {
            self.put_sample(report, now);
        }
    }

    fn put_sample(&mut self, report: &TickReport, now: Micros) {
        let Self { guarded, outbox, health, published, .. } = self;
        guarded.fill_sample(report);
        outbox.put(|outgoing| {
            std::mem::swap(&mut outgoing.sample, &mut guarded.sample);
            outgoing.has_sample = true;
            if !Arc::ptr_eq(&outgoing.version, &guarded.version) {
                // The region builder holds the former version, so nothing is freed here.
                outgoing.version = guarded.version.clone();
            }
            (outgoing.t_s, outgoing.sequence) = (now.0 as f64 * 1e-6, guarded.sequence());
            outgoing.doubt = guarded.doubt;
            outgoing.table = guarded.table.revision;
            outgoing.health = std::mem::replace(health, HealthStatus { tick_max_us: 0, ..*health });
            *published = Some(now);
        });
    }
}
