//! Guarded robot with its monitor and the sources of its regions: the tick, without threads or a network.

use std::sync::Arc;

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, Follow, Frames};
use elbowroom_interlock::Micros;
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{
    AccessClass, Fault, Interlock, Monitor, OverrideReason, RegionId, Snapshot, SourceState, TickReport,
};
use elbowroom_recording::TickRecorder;
use elbowroom_status::StatusSample;

use super::attached_volumes::AttachedVolumes;
use super::doubt::Doubt;
use super::followed_robot::FollowedRobot;
use super::inbox::Contents;
use super::measured_frame::{LOST, MeasuredFrame};
use super::next_configuration::{NextConfiguration, NodeVersion};
use super::node_monitor::NodeMonitor;
use super::standstill::Standstill;
use crate::messages::{JointState, MAX_JOINTS, OverrideAnswer};
use crate::regions_table::{RegionTable, TABLE_VALIDITY};

/// One guarded robot. Its memory is allocated at its creation; [`Self::tick`] allocates nothing.
pub(super) struct GuardedRobot {
    cell: Arc<Cell>,
    setup: MonitorSetup,
    monitor: NodeMonitor,
    own: OwnJoints,
    carriers: Carriers,
    sources: Vec<SourceState>,
    attached: AttachedVolumes,
    pub(super) table: ReceivedTable,
    /// Whether the robot stops until it has received a table of regions.
    pub(super) awaits_regions: bool,
    /// Fault in the input.
    pub(super) doubt: Option<Doubt>,
    /// Configuration of the monitor, for display of its results.
    pub(super) version: Arc<NodeVersion>,
    answers: u64,
    checksum: u64,
    pub(super) sample: StatusSample,
    recorder: Option<TickRecorder>,
}

/// The table of regions that was received last.
pub(super) struct ReceivedTable {
    pub(super) revision: (u64, u64),
    /// Whether each region of the cell is on.
    active: Vec<bool>,
}

/// What the robot's own controller has sent.
struct OwnJoints {
    state: JointState,
    /// Time of the joint values, on the controller's clock. `now` is the present time on that clock.
    stamp: Option<Micros>,
    now: Micros,
    standstill: Standstill,
}

impl OwnJoints {
    /// The input of a tick; `None` before the first joint values.
    fn snapshot<'a>(&'a self, sources: &'a [SourceState]) -> Option<Snapshot<'a>> {
        Some(Snapshot {
            now_s: seconds(self.now),
            stamp_s: seconds(self.stamp?),
            q: &self.state.q,
            qd: &self.state.qd,
            qdd: &[],
            programmed_override: self.state.programmed_override,
            intent: (!self.state.intent.is_empty()).then_some(&self.state.intent),
            sources,
        })
    }

    /// Age of the joint values; `None` before the first ones.
    fn age(&self) -> Option<Micros> {
        self.stamp.map(|stamp| self.now - stamp)
    }
}

/// What regions can follow: the robots of the cell, of which only the followed ones are up to date, and measured sources.
struct Carriers {
    chains: Vec<ChainState>,
    followed: Vec<FollowedRobot>,
    measured: Vec<MeasuredFrame>,
    /// States of the measured sources in the present tick.
    measured_states: Vec<SourceState>,
}

/// Disagreement of two clocks after a second of silence, s.
const DRIFT_S: f64 = 1e-3;

impl GuardedRobot {
    pub(super) fn new(
        cell: Arc<Cell>,
        setup: MonitorSetup,
        monitor: NodeMonitor,
        checksum: u64,
        recorder: Option<TickRecorder>,
    ) -> Self {
        Self {
            own: OwnJoints {
                state: JointState::with_capacity(),
                stamp: None,
                now: Micros(0),
                standstill: Standstill::new(MAX_JOINTS),
            },
            carriers: Carriers {
                chains: cell.robots.iter().map(|r| ChainState::new(&r.robot.chain)).collect(),
                followed: vec![FollowedRobot::default(); cell.robots.len()],
                measured: MeasuredFrame::all(&cell),
                measured_states: Vec::with_capacity(cell.frame_sources.measured.len()),
            },
            sources: Vec::with_capacity(setup.sources.len()),
            attached: AttachedVolumes::new(&setup.configuration),
            doubt: None,
            table: ReceivedTable { revision: (0, 0), active: RegionTable::initial(&cell).active },
            awaits_regions: false,
            version: Arc::new(NodeVersion { number: String::new(), configuration: setup.configuration.clone() }),
            answers: 0,
            checksum,
            sample: StatusSample::new(monitor.monitor()),
            monitor,
            recorder,
            setup,
            cell,
        }
    }

    /// Reads the input that has arrived, while the inbox is locked.
    pub(super) fn take(&mut self, inbox: &mut Contents, now: Micros) {
        if std::mem::take(&mut inbox.own.is_new) {
            std::mem::swap(&mut self.own.state, &mut inbox.own.state);
            self.own.stamp = inbox.own.stamp;
            self.own.standstill.hear(self.own.state.boot);
        }
        self.own.now = inbox.own.now(now);
        let Carriers { chains, followed, measured, .. } = &mut self.carriers;
        for (robot, heard) in inbox.followed.iter_mut().enumerate() {
            let Some(heard) = heard else { continue };
            followed[robot].take(heard, &self.cell.robots[robot].robot.chain, &mut chains[robot], now);
        }
        for (frame, heard) in measured.iter_mut().zip(&mut inbox.measured) {
            frame.take(heard, &self.cell, now);
        }
        if std::mem::take(&mut inbox.has_grants) {
            self.monitor.receive(&inbox.grants);
        }
        self.take_regions(inbox, now);
    }

    /// Reads the table of regions; exchanges the monitor if another one was built.
    fn take_regions(&mut self, inbox: &mut Contents, now: Micros) {
        if let Some(mut next) = inbox.take_built() {
            self.replace(&mut next, inbox);
            inbox.left_over = Some(next);
        }
        self.table.revision = inbox.regions.revision;
        let is_known = inbox.regions_heard.is_some_and(|heard| now - heard <= TABLE_VALIDITY);
        if is_known {
            self.table.active.copy_from_slice(&inbox.regions.active);
        } else {
            self.table.active.fill(true);
        }
        let table = &inbox.regions;
        let may_have_changed = table.is_editable && !is_known || self.awaits_regions && inbox.regions_heard.is_none();
        let is_recent = |heard: Option<Micros>| heard.is_some_and(|heard| now - heard <= TABLE_VALIDITY);
        self.doubt = match () {
            () if is_recent(inbox.other_cell_heard) => Some(Doubt::OtherCell),
            () if may_have_changed => Some(Doubt::NoTable),
            () if !table.permits(&inbox.number) => Some(Doubt::NotBuilt),
            // A late message is refused now and then; that matters only if no other one arrives.
            () if self.is_stale() => inbox.own.refused.map(Doubt::Refused),
            () => self.doubt_of_sources(inbox),
        };
    }

    /// Why a measured source that a region follows is lost, if its sender is heard.
    fn doubt_of_sources(&self, inbox: &Contents) -> Option<Doubt> {
        let (frames, stale) = (Frames::new(&self.cell), Micros::from_seconds(self.cell.monitoring.laws.stale_s));
        let doubt = |source: usize| {
            let (frame, heard) = (&self.carriers.measured[source], &inbox.measured[source]);
            let is_lost = frame.age.is_none_or(|age| age > stale);
            heard.refused.map(Doubt::SourceRefused).or(frame.doubt()).filter(|_| is_lost)
        };
        self.setup.sources.iter().filter_map(|follow| frames.measured_source(follow)).find_map(doubt)
    }

    /// Continues with other regions. Nothing is allocated or freed: `next` then holds the former parts.
    fn replace(&mut self, next: &mut NextConfiguration, inbox: &mut Contents) {
        for (on, before) in next.active_of_inbox.iter_mut().zip(&next.before) {
            *on = before.map_or_else(|on| on, |before| inbox.regions.active[before]);
        }
        std::mem::swap(&mut inbox.regions.active, &mut next.active_of_inbox);
        std::mem::swap(&mut inbox.cell, &mut next.cell_of_inbox);
        std::mem::swap(&mut inbox.number, &mut next.number);
        self.monitor.replace(&mut next.monitor, &next.same);
        std::mem::swap(&mut self.table.active, &mut next.active);
        std::mem::swap(&mut self.cell, &mut next.cell);
        std::mem::swap(&mut self.setup, &mut next.setup);
        std::mem::swap(&mut self.sources, &mut next.sources);
        std::mem::swap(&mut self.version, &mut next.version);
        let same = &next.same;
        self.sample.renumber(|old| same.iter().position(|s| *s == Some(old)).map(RegionId));
        // The recording ends here for comparison: a replayed monitor would not know the state that this one continues with.
        next.recorder = self.recorder.take();
    }

    pub(super) fn interlock(&self) -> Option<Interlock> {
        self.monitor.interlock()
    }

    pub(super) fn monitor(&self) -> &Monitor {
        self.monitor.monitor()
    }

    /// Whether the joint values are too old, or none have arrived yet.
    pub(super) fn is_stale(&self) -> bool {
        self.own.age().is_none_or(|age| age > Micros::from_seconds(self.cell.monitoring.laws.stale_s))
    }

    /// Computes the override for the joint values that arrived last. `now` is on this process's clock.
    pub(super) fn tick(&mut self, now: Micros) -> TickReport {
        self.switch_regions();
        let is_attached = self.attach();
        self.place_sources(now);
        let Some(snapshot) = self.own.snapshot(&self.sources) else { return silent() };
        let fault = match (self.doubt.is_some_and(Doubt::is_of_regions), is_attached) {
            (true, _) => Some(Fault::Regions),
            // The monitor does not know a volume that the robot carries.
            (false, false) => Some(Fault::WrongLength),
            (false, true) => None,
        };
        self.monitor.monitor_mut().set_external_fault(fault);
        let report = self.monitor.tick(&snapshot, now);
        if let Some(recorder) = &mut self.recorder {
            recorder.tick(seconds(now), &snapshot, &report, self.monitor.monitor());
        }
        let has_jumped = matches!(report.reason, OverrideReason::Fault(Fault::TooFast { .. }));
        self.sample.add_events(self.monitor.monitor());
        self.notice_standstill(has_jumped, now);
        report
    }

    /// Accepts a new place of the robot after a second of rest there, if the joint values have jumped (the robot was
    /// moved by hand or with its controller off) or its controller has started again.
    fn notice_standstill(&mut self, has_jumped: bool, now: Micros) {
        let state = &self.own.state;
        if self.own.standstill.ends(has_jumped, &state.q, &state.qd, now) {
            self.monitor.monitor_mut().forget_position();
            if let Some(recorder) = &mut self.recorder {
                recorder.forgot_position();
            }
        }
    }

    /// Fills the sample with the result of the last tick, which takes longer than a tick.
    pub(super) fn fill_sample(&mut self, report: &TickReport) {
        match self.own.snapshot(&self.sources) {
            Some(snapshot) => self.sample.fill(self.monitor.monitor(), &snapshot, report),
            None => self.sample.fill_without_input(report),
        }
    }

    /// Makes the answer to the controller.
    pub(super) fn answer(&mut self, report: &TickReport) -> OverrideAnswer {
        self.answers += 1;
        OverrideAnswer {
            checksum: self.checksum,
            boot: self.own.state.boot,
            echo: self.own.state.sequence,
            sequence: self.answers,
            speed_override: report.speed_override,
            outputs: report.outputs,
            reason: match report.reason {
                OverrideReason::Free => 0,
                OverrideReason::Region(_) => 1,
                OverrideReason::SpeedZone(_) => 2,
                OverrideReason::Waiting(_) => 3,
                OverrideReason::Rate => 4,
                OverrideReason::Fault(_) => 5,
                OverrideReason::Halted(_) => 6,
            },
            region: report.reason.region().map_or(u16::MAX, |r| r.0 as u16),
        }
    }

    /// Returns the bytes of the next message to the arbiter; empty if no region needs one.
    pub(super) fn interlock_state(&mut self, now: Micros) -> &[u8] {
        self.monitor.state(now)
    }

    /// Whether the last tick has changed the occupancy that the arbiter has to know.
    pub(super) fn interlock_has_news(&mut self) -> bool {
        self.monitor.has_news()
    }

    /// Sequence number of the message that the last answer was for.
    pub(super) fn sequence(&self) -> u64 {
        self.own.state.sequence
    }

    fn switch_regions(&mut self) {
        for (local, region) in self.setup.regions.iter().enumerate() {
            let (id, on) = (RegionId(local), self.table.active[region.0]);
            let monitor = self.monitor.monitor_mut();
            if monitor.is_active(id) != on {
                // Permanent regions are always on in a table, so the switch is never refused.
                let _ = monitor.switch(id, on, AccessClass::Programmer);
                if let Some(recorder) = &mut self.recorder {
                    recorder.switched(id, on);
                }
            }
        }
    }

    /// Attaches and detaches the optional volumes that the controller names. False if it names an unknown volume.
    fn attach(&mut self) -> bool {
        let Self { monitor, attached, own, recorder, .. } = self;
        attached.apply(&own.state.attached, monitor.monitor_mut(), |volume, in_link| {
            let Some(recorder) = recorder else { return };
            match in_link {
                Some(in_link) => recorder.attached(volume, in_link),
                None => recorder.detached(volume),
            }
        })
    }

    fn place_sources(&mut self, now: Micros) {
        let Self { cell, setup, carriers, sources, .. } = self;
        let Carriers { chains, followed, measured, measured_states } = carriers;
        measured_states.clear();
        measured_states.extend(measured.iter().map(|frame| frame.state(cell).unwrap_or(LOST)));
        let frames = Frames::with_measured(cell, measured_states);
        for (index, follow) in setup.sources.iter().enumerate() {
            // Stamps are on the clock of this robot's controller, like those of its joint values.
            let age = match (follow, frames.measured_source(follow)) {
                (Follow::Robot { robot, .. }, _) => followed[robot.0].age,
                (_, Some(source)) => measured[source].age,
                (_, None) => Some(Micros(0)),
            };
            let state = age.map_or(LOST, |age| SourceState {
                stamp_s: seconds(self.own.now) - seconds(age),
                ..frames.source(follow, chains, seconds(now))
            });
            match sources.get_mut(index) {
                Some(before) => *before = not_set_back(before, state),
                None => sources.push(state),
            }
        }
    }
}

/// The later of two states, if the clocks of sender and controller disagree by as little as they may drift apart:
/// otherwise a tick without news would find the source at a time before that of the last tick, which is a fault.
fn not_set_back(before: &SourceState, next: SourceState) -> SourceState {
    let is_set_back = next.stamp_s < before.stamp_s && before.stamp_s - next.stamp_s <= DRIFT_S;
    if is_set_back { *before } else { next }
}

fn seconds(time: Micros) -> f64 {
    time.0 as f64 * 1e-6
}

/// The stop before the first joint values.
fn silent() -> TickReport {
    let reason = OverrideReason::Fault(Fault::Stale);
    TickReport { stamp_s: 0.0, speed_override: 0.0, reason, governing: None, outputs: 0, measured_pairs: 0 }
}
