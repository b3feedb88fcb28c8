//! Processes of a simulated service: the one that keeps the regions and grants exchange regions, and one per robot.

use std::path::{Path, PathBuf};
use std::rc::Rc;
use std::sync::{Arc, Mutex};

use elbowroom_cell::access::ControlLog;
use elbowroom_cell::configure;
use elbowroom_interlock::{Boot, Micros};
use elbowroom_robot::RobotId;

use super::cell::SimulatedCell;
use super::network::{Host, SimulatedNetwork, Wires};
use super::process_clock::{ProcessClock, ProcessId, true_us};
use super::recording::NodeRecording;
use crate::arbiter_service::ArbiterService;
use crate::clock::Clock;
use crate::control::{ControlParts, JointsHeard, NodesHeard, RequestHandler};
use crate::measured_sources::MeasuredSources;
use crate::network::Network;
use crate::node::{Node, NodeParts};
use crate::region_journal::RegionJournal;
use crate::region_keeper::{ProgramSwitches, RegionKeeper};
use crate::worker::{Step, take_adopted};

/// Hosts: the arbiter's, then those of nodes, of controllers, of the belt, and of strangers.
pub(super) const ARBITER: Host = 0;
pub(super) const BELT: Host = 20;
pub(super) const STRANGER: Host = 21;
pub(super) const fn node_host(rail: usize) -> Host {
    1 + rail
}
pub(super) const fn controller_host(rail: usize) -> Host {
    10 + rail
}

/// A running process.
pub(super) struct Process {
    pub(super) id: ProcessId,
    pub(super) host: Host,
    pub(super) paused_until_us: u64,
    pub(super) steps: Vec<Step>,
    pub(super) parts: Parts,
}

/// What runs in a process.
pub(super) enum Parts {
    Arbiter(ArbiterParts),
    /// The node of a robot, and what it records.
    Node(Box<Node>, Option<NodeRecording>),
}

/// The parts that decide about regions.
#[derive(Clone)]
pub(super) struct ArbiterParts {
    pub(super) keeper: Arc<RegionKeeper>,
    pub(super) arbiter: Arc<ArbiterService>,
    pub(super) handler: Rc<RequestHandler>,
}

/// Where a process starts.
pub(super) struct Start {
    pub(super) host: Host,
    pub(super) clock: ProcessClock,
    /// Higher than at earlier starts, unless the time of day was set back.
    pub(super) boot: u64,
    pub(super) network: Arc<dyn Network>,
}

impl Start {
    pub(super) fn new(wires: &Arc<Mutex<Wires>>, host: Host, clock: (u64, f64), boot: u64) -> Self {
        let process = crate::locked::locked(wires).add_process(host);
        let clock = ProcessClock { process, offset_us: clock.0, rate: clock.1 };
        Self { host, clock, boot, network: Arc::new(SimulatedNetwork::new(wires, process)) }
    }

    fn process(self, parts: Parts) -> Process {
        let Self { host, clock, .. } = self;
        Process { id: clock.process, host, paused_until_us: 0, steps: take_adopted(), parts }
    }

    /// Starts the arbiter, with the files of earlier starts in this folder.
    pub(super) fn arbiter(self, cell: &SimulatedCell, folder: &Path, programs: ProgramSwitches) -> Process {
        let (clock, network) = (Clock::simulated(self.clock), &self.network);
        let journal = RegionJournal::open(&journal(folder));
        let keeper = RegionKeeper::start(&cell.versions, (network, clock), self.boot, programs, journal, None);
        let keeper = Arc::new(keeper.expect("keys"));
        let arbiter = ArbiterService::start(&cell.cell, network, self.boot, clock, None);
        let arbiter = Arc::new(arbiter.expect("keys").expect("exchange regions"));
        let parts = ControlParts {
            versions: cell.versions.clone(),
            keeper: keeper.clone(),
            arbiter: Some(arbiter.clone()),
            nodes: NodesHeard::start(&cell.cell, network, clock).expect("keys"),
            joints: JointsHeard::start(&cell.cell, network, clock, Micros(0)).expect("keys"),
            measured: MeasuredSources::start(&cell.cell, network, clock).expect("keys"),
            clock,
            on_event: None,
        };
        keeper.allow_edits();
        let log = ControlLog::open(&folder.join("cell.control.jsonl")).unwrap_or_else(|e| panic!("{e}"));
        let handler = Rc::new(RequestHandler::new(parts, log));
        handler.log_start();
        self.process(Parts::Arbiter(ArbiterParts { keeper, arbiter, handler }))
    }

    /// Starts the node of a robot, with the file of the cell or with the other one; it records into this folder.
    pub(super) fn node(
        self,
        cell: &SimulatedCell,
        rail: usize,
        has_other_file: bool,
        folder: Option<&Path>,
    ) -> Process {
        let (cell, versions) =
            if has_other_file { (&cell.other, &cell.other_versions) } else { (&cell.cell, &cell.versions) };
        let networks = [self.network.clone(), self.network.clone()];
        let clock = Clock::simulated(self.clock);
        let setup = configure::setups(cell).expect("setups").swap_remove(rail);
        let parts = NodeParts::new(cell, (RobotId(rail), setup), Boot(self.boot), clock, networks);
        let parts = parts.unwrap_or_else(|e| panic!("{e}"));
        let recording = folder.map(|folder| NodeRecording::start(cell, folder, self.boot));
        let of_robot = |r: &NodeRecording| r.recorder.robot(rail as u32, parts.monitor.monitor(), clock.seconds());
        let recorder = recording.as_ref().map(of_robot);
        let parts = NodeParts { recorder, versions: Some(versions.clone()), ..parts };
        self.process(Parts::Node(Box::new(Node::start(parts).expect("keys")), recording))
    }
}

impl Process {
    pub(super) fn runs(&self) -> bool {
        true_us() >= self.paused_until_us
    }

    /// Ends it, and returns what its recording shows.
    pub(super) fn end(self) -> Option<(u64, Option<String>)> {
        drop(self.steps);
        match self.parts {
            Parts::Arbiter(_) => None,
            Parts::Node(node, recording) => {
                drop(node);
                recording.map(NodeRecording::finish)
            }
        }
    }

    /// Handles what has arrived.
    pub(super) fn step(&mut self) {
        for step in &mut self.steps {
            step(std::time::Duration::ZERO);
        }
    }
}

/// The journal of the regions in a folder.
pub(super) fn journal(folder: &Path) -> PathBuf {
    folder.join("cell.regions.json")
}

/// The file that signs the log of changes.
pub(super) fn log_head(folder: &Path) -> PathBuf {
    folder.join("cell.control.head")
}
