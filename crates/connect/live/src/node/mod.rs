//! Node of a cell: guards one robot. Joint states in, overrides out.
//!
//! A node has four kinds of threads: threads of the network put input into the inbox; the tick's own thread computes
//! the override, without allocation, when joint values arrive; one thread sends; one thread builds monitors for regions
//! that are moved, added and removed. So the network never delays a tick.

mod attached_volumes;
mod doubt;
mod followed_robot;
mod guarded_robot;
mod inbox;
mod input_gate;
mod measured_frame;
mod next_configuration;
mod node_monitor;
mod node_tick;
mod outbox;
mod region_builder;
mod standstill;

use std::sync::Arc;
use std::time::Duration;

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, configure};
use elbowroom_formats::Diagnostic;
use elbowroom_interlock::Boot;
use elbowroom_interlock::wire::MAX_BYTES;
use elbowroom_kinematics::ChainState;
use elbowroom_monitor::{Configuration, RobotSlot};
use elbowroom_robot::RobotId;
use elbowroom_spatial::Pose;
use elbowroom_status::{EventStatus, HealthStatus, RobotStatus, ServiceStatus, StatusSample};

use elbowroom_recording::TickRecorder;

use crate::cell_versions::CellVersions;
use crate::clock::Clock;
use crate::configuration_number::configuration_number;
use crate::keys::Keys;
use crate::measured_sources::key_of;
use crate::network::{Network, NetworkError, Publisher, Subscription, Urgency};
use crate::regions_table::RegionTableMessage;
use crate::worker::Worker;
use doubt::Doubt;
use inbox::Inbox;
use next_configuration::NodeVersion;
use node_tick::follows;
use outbox::Outbox;
use region_builder::AGAIN_AFTER;

pub(crate) use attached_volumes::AttachedVolumes;
pub(crate) use inbox::Heard;
pub use input_gate::{InputGate, Rejected};
pub(crate) use measured_frame::{LOST, MeasuredFrame};
pub use node_monitor::NodeMonitor;
pub use node_tick::NodeTick;
pub use region_builder::{RegionBuilder, RegionsError};

/// Longest wait for something to send.
const NOTHING_TO_SEND: Duration = Duration::from_secs(1);

/// Parts of a node.
pub struct NodeParts {
    /// The cell.
    pub cell: Arc<Cell>,
    /// The robot to guard.
    pub robot: RobotId,
    /// Setup of its monitor.
    pub setup: MonitorSetup,
    /// Its monitor, made from this setup.
    pub monitor: NodeMonitor,
    /// [`configuration_number`](crate::configuration_number) of the cell.
    pub checksum: u64,
    /// The clock of the process.
    pub clock: Clock,
    /// Network of joint states, overrides and statuses.
    pub network: Arc<dyn Network>,
    /// Network of the arbiter.
    pub interlocks: Arc<dyn Network>,
    /// Recorder of every tick.
    pub recorder: Option<TickRecorder>,
    /// Versions of the cell, for regions that are moved, added and removed while the node runs; the robot then stops
    /// until a table of regions is received. `None` if the regions cannot change while the cell runs.
    pub versions: Option<Arc<CellVersions>>,
}

impl NodeParts {
    /// Parts of the node of a robot: without a recorder, and with the regions of the cell file alone. `networks` are that
    /// of the controllers and that of the arbiter; `boot` is higher than at earlier starts.
    ///
    /// # Errors
    /// A monitor cannot have these regions.
    pub fn new(
        cell: &Arc<Cell>,
        (robot, setup): (RobotId, MonitorSetup),
        boot: Boot,
        clock: Clock,
        [network, interlocks]: [Arc<dyn Network>; 2],
    ) -> Result<Self, Diagnostic> {
        let slots = configure::slots(cell).iter().flatten().map(|slot| slot.0 + 1).max().unwrap_or(0);
        let checksum = configuration_number(cell);
        let monitor = NodeMonitor::new(&setup, RobotSlot(robot.0), slots, checksum, boot)
            .map_err(|e| Diagnostic::new(&cell.file, cell.robots[robot.0].line, e))?;
        let (cell, recorder, versions) = (cell.clone(), None, None);
        Ok(Self { cell, robot, setup, monitor, checksum, clock, network, interlocks, recorder, versions })
    }
}

/// A running node. It ends when it is dropped.
pub struct Node {
    is_guard: bool,
    inbox: Arc<Inbox>,
    outbox: Arc<Outbox>,
    workers: Vec<Worker>,
    _subscriptions: Vec<Subscription>,
    // Kept because a network may end with its last owner.
    _networks: [Arc<dyn Network>; 2],
}

impl Node {
    /// Whether it guards a robot: the node of a mechanism reads its joint values, for those who show it.
    pub(crate) fn is_guard(&self) -> bool {
        self.is_guard
    }

    /// Starts to guard a robot, or to read a mechanism.
    ///
    /// # Errors
    /// [`NetworkError`] if a key cannot be used.
    ///
    /// # Panics
    /// If the system cannot start a thread.
    pub fn start(parts: NodeParts) -> Result<Self, NetworkError> {
        let NodeParts { cell, robot, setup, monitor, checksum, clock, network, interlocks, recorder, versions } = parts;
        let (keys, name) = (Keys::new(&cell.name), cell.robots[robot.0].name.clone());
        let is_guard = !cell.robots[robot.0].is_mechanism();
        let followed: Vec<bool> = (0..cell.robots.len()).map(|r| follows(&setup, RobotId(r))).collect();
        let (state, sample) = (ChainState::new(setup.configuration.chain()), StatusSample::new(monitor.monitor()));
        let mut tick = NodeTick::new(cell.clone(), setup, monitor, checksum, recorder);
        let builder = versions.map(|versions| {
            tick.await_regions();
            tick.region_builder(robot, versions)
        });
        let (inbox, outbox) = (tick.inbox().clone(), tick.outbox().clone());
        let networks = [&*network, &*interlocks];
        let mut subscriptions = subscribe(networks, &keys, &cell, robot, &followed, &inbox, clock)?;
        let grants = inbox.clone();
        let handler = Box::new(move |bytes: &[u8]| grants.take_grants(bytes));
        subscriptions.push(interlocks.subscribe(&keys.interlock_grants(&name), handler)?);
        let mut sender = Sender {
            bytes: Vec::with_capacity(256),
            state: Vec::with_capacity(MAX_BYTES),
            answers: network.publisher(&keys.speed_override(&name), Urgency::RealTime)?,
            statuses: network.publisher(&keys.status(&name), Urgency::Display)?,
            states: interlocks.publisher(&keys.interlock_state(&name), Urgency::RealTime)?,
            chain: state,
            sample,
            cell,
            robot,
        };
        let networks = [network, interlocks];
        // Its drop closes the boxes, also if a thread cannot be started.
        let mut node = Self {
            is_guard,
            inbox,
            outbox: outbox.clone(),
            workers: Vec::new(),
            _subscriptions: subscriptions,
            _networks: networks,
        };
        if let Some(mut builder) = builder {
            let build = Box::new(move |longest| builder.wait_and_build(clock, longest));
            node.workers.push(Worker::start(&format!("build {name}"), clock, AGAIN_AFTER, build));
        }
        let stale = tick.stale();
        let tick = Box::new(move |longest| tick.wait_and_tick(clock, longest));
        node.workers.push(Worker::start(&format!("tick {name}"), clock, stale, tick));
        let send = Box::new(move |longest| sender.wait_and_send(&outbox, longest));
        node.workers.push(Worker::start(&format!("send {name}"), clock, NOTHING_TO_SEND, send));
        Ok(node)
    }
}

impl Drop for Node {
    fn drop(&mut self) {
        self.inbox.close();
        self.outbox.put(|o| o.is_closed = true);
        // A thread that panicked has stopped answering, so the controller has stopped by itself.
        self.workers.clear();
    }
}

/// Subscribes to all inputs. Joint values come from the network of the controllers; the table of regions never does, as
/// anybody may send a datagram.
fn subscribe(
    [network, shared]: [&dyn Network; 2],
    keys: &Keys,
    cell: &Arc<Cell>,
    robot: RobotId,
    followed: &[bool],
    inbox: &Arc<Inbox>,
    clock: Clock,
) -> Result<Vec<Subscription>, NetworkError> {
    let own = inbox.clone();
    let handler = Box::new(move |bytes: &[u8]| own.take_joint_state(bytes, clock.micros()));
    let mut subscriptions = vec![network.subscribe(&keys.joint_states(&cell.robots[robot.0].name), handler)?];
    for other in (0..followed.len()).filter(|r| followed[*r]) {
        let inbox = inbox.clone();
        let handler = Box::new(move |bytes: &[u8]| inbox.take_followed(RobotId(other), bytes, clock.micros()));
        subscriptions.push(network.subscribe(&keys.joint_states(&cell.robots[other].name), handler)?);
    }
    for (index, source) in cell.frame_sources.measured.iter().enumerate() {
        let inbox = inbox.clone();
        let handler = Box::new(move |bytes: &[u8]| inbox.take_measured(index, bytes, clock.micros()));
        subscriptions.push(network.subscribe(&key_of(keys, cell, *source), handler)?);
    }
    let inbox = inbox.clone();
    let handler = Box::new(move |bytes: &[u8]| {
        let Ok(message) = serde_json::from_slice::<RegionTableMessage>(bytes) else { return };
        inbox.take_regions(&message, clock.micros());
    });
    subscriptions.push(shared.subscribe(&keys.regions(), handler)?);
    Ok(subscriptions)
}

/// The thread that sends.
struct Sender {
    answers: Box<dyn Publisher>,
    statuses: Box<dyn Publisher>,
    /// Messages to the arbiter.
    states: Box<dyn Publisher>,
    sample: StatusSample,
    chain: ChainState,
    cell: Arc<Cell>,
    robot: RobotId,
    /// Memory for an answer, and for a message to the arbiter.
    bytes: Vec<u8>,
    state: Vec<u8>,
}

impl Sender {
    /// Waits until there is something to send, and sends it. False at the end.
    fn wait_and_send(&mut self, outbox: &Outbox, longest: Duration) -> bool {
        self.state.clear();
        let (answer, status) = {
            let mut outgoing = outbox.wait(longest);
            if outgoing.is_closed {
                return false;
            }
            std::mem::swap(&mut self.state, &mut outgoing.state);
            let sample = outgoing.take_sample(&mut self.sample);
            let (doubt, table) = (outgoing.doubt, outgoing.table);
            (outgoing.answer.take(), sample.map(|sample| (sample, (outgoing.version.clone(), table), doubt)))
        };
        if let Some(answer) = answer {
            answer.encode(&mut self.bytes);
            self.answers.publish(&self.bytes);
        }
        if !self.state.is_empty() {
            self.states.publish(&self.state);
        }
        if let Some(((t_s, sequence, health), version, doubt)) = status {
            self.publish_status(t_s, sequence, health, &version, doubt);
        }
        true
    }

    fn publish_status(
        &mut self,
        t_s: f64,
        sequence: u64,
        health: HealthStatus,
        (version, table): &(Arc<NodeVersion>, (u64, u64)),
        doubt: Option<Doubt>,
    ) {
        let tcp = self.tcp(&version.configuration);
        let mut status = RobotStatus::of_sample(t_s, &version.configuration, &self.sample, tcp.as_ref());
        status.sequence = sequence;
        if self.sample.joint_positions().is_empty() {
            "no joint values from the controller yet".clone_into(&mut status.reason);
        }
        if let Some(doubt) = doubt {
            status.reason = format!("{}: {doubt}", status.reason);
        }
        let events = self.events(t_s, &version.configuration);
        status.service = ServiceStatus { configuration: version.number.clone(), table: *table, health, events };
        if let Ok(json) = serde_json::to_vec(&status) {
            self.statuses.publish(&json);
        }
    }

    fn events(&mut self, t_s: f64, configuration: &Configuration) -> Vec<EventStatus> {
        let name = |r: Option<elbowroom_monitor::RegionId>| {
            r.map_or_else(String::new, |r| configuration.regions()[r.0].name.clone())
        };
        let robot = configuration.robot();
        let (events, _) = self.sample.take_events();
        let event = |e: elbowroom_monitor::Event| EventStatus {
            t_s,
            robot: robot.to_owned(),
            region: name(e.region),
            event: e.kind.name().to_owned(),
        };
        events.map(event).collect()
    }

    /// Computes the pose of the TCP in the world at the joint values of the sample: that of the tool that is mounted, as
    /// the grids have it.
    fn tcp(&mut self, configuration: &Configuration) -> Option<Pose> {
        let q = self.sample.joint_positions();
        if q.len() != self.chain.q.len() {
            return None;
        }
        self.chain.q.copy_from_slice(q);
        configuration.chain().forward(&mut self.chain);
        let robot = &self.cell.robots[self.robot.0];
        let link = configuration.volumes()[self.sample.tcp()?.0].link;
        Some(robot.base_in_world * self.chain.link_in_root(link) * robot.tcp_in_link(link))
    }
}
