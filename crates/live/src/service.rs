//! A process of a live cell: nodes, arbiter, simulated controllers, in any combination.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use elbowroom_cell::{Cell, configure};
use elbowroom_formats::FormatError;
use elbowroom_interlock::Boot;
use elbowroom_monitor::{RegionKind, RobotSlot};
use elbowroom_robot::RobotId;
use elbowroom_rosbag::{BagError, CellWriter, Recorder};
use elbowroom_view::{Server, ServerSettings, StatusFeed};

use crate::arbiter_service::{ArbiterService, EventHandler};
use crate::cell_observer::CellObserver;
use crate::clock::{Clock, boot_number};
use crate::configuration_number::configuration_number;
use crate::network::{Network, ZenohNetwork, ZenohSettings};
use crate::node::{Node, NodeMonitor, NodeParts};
use crate::region_keeper::RegionKeeper;
use crate::ros2::{Participant, Ros2Settings};
use crate::service_error::ServiceError;
use crate::simulated_controllers::SimulatedControllers;

/// The address of a service without another one.
pub const DEFAULT_ADDRESS: &str = "127.0.0.1:7447";

/// What a process of a live cell does.
#[derive(Clone, Default)]
pub struct ServiceOptions {
    /// The robots that it guards; empty: all, or none where it is only the arbiter.
    pub robots: Vec<String>,
    /// Accepts connections here.
    pub listen: Option<String>,
    /// Connects here.
    pub connect: Option<String>,
    /// Grants exchange regions, and keeps which regions are switched on.
    pub arbiter: bool,
    /// Runs the programs of the cell file in place of the controllers.
    pub simulate: bool,
    /// Shows the cell in a browser at this address.
    pub web: Option<String>,
    /// Records everything that this process guards into this file.
    pub record: Option<PathBuf>,
    /// What it has to do with ROS 2.
    pub ros2: Ros2Settings,
    /// Called with every event of the arbiter of this process, in words.
    pub on_event: Option<EventHandler>,
}

/// A running process of a live cell; it ends when it is dropped.
pub struct Service {
    // In the order in which they end: controllers stop first.
    controllers: Option<SimulatedControllers>,
    ros2: Option<Participant>,
    nodes: Vec<Node>,
    arbiter: Option<ArbiterService>,
    keeper: Option<RegionKeeper>,
    observer: Option<CellObserver>,
    server: Option<Server>,
    network: Arc<ZenohNetwork>,
}

impl Service {
    /// Starts what the options say.
    ///
    /// # Errors
    /// [`ServiceError`]; then nothing runs.
    pub fn start(cell: Cell, options: &ServiceOptions) -> Result<Self, ServiceError> {
        let cell = Arc::new(stopping_in_time(cell));
        let robots = guarded_robots(&cell, options)?;
        let is_whole_cell = options.robots.is_empty() && !options.arbiter;
        let listen = match (&options.listen, &options.connect) {
            (None, None) => Some(DEFAULT_ADDRESS.to_owned()),
            (listen, _) => listen.clone(),
        };
        let network = Arc::new(ZenohNetwork::open(&ZenohSettings { listen, connect: options.connect.clone() })?);
        let shared: Arc<dyn Network> = network.clone();
        let clock = Clock::start();
        let (mut keeper, mut arbiter) = (None, None);
        if options.arbiter || is_whole_cell {
            keeper = Some(RegionKeeper::start(&cell, &shared, boot_number())?);
            arbiter = ArbiterService::start(&cell, &shared, boot_number(), options.on_event.clone())?;
        }
        let slots = configure::slots(&cell).iter().flatten().map(|slot| slot.0 + 1).max().unwrap_or(0);
        let checksum = configuration_number(&cell);
        let recorder = options.record.as_ref().map(|file| start_recorder(file, &cell)).transpose()?;
        let mut nodes = Vec::new();
        for (i, setup) in
            configure::setups(&cell)?.into_iter().enumerate().filter(|(i, _)| robots.contains(&RobotId(*i)))
        {
            let monitor = NodeMonitor::new(&setup, RobotSlot(i), slots, checksum, Boot(boot_number()));
            let monitor = monitor.map_err(|e| FormatError::new(&cell.file, cell.robots[i].line, e.to_string()))?;
            let tick_recorder = recorder.as_ref().map(|r| r.robot(i as u32, monitor.monitor(), clock.seconds()));
            nodes.push(Node::start(NodeParts {
                cell: cell.clone(),
                robot: RobotId(i),
                setup,
                monitor,
                checksum,
                clock,
                network: shared.clone(),
                interlocks: shared.clone(),
                recorder: tick_recorder,
            })?);
        }
        let ros2 = Participant::start(&cell, &options.ros2, &robots, &shared, clock, options.on_event.clone())?;
        let simulated: Vec<RobotId> =
            robots.iter().copied().filter(|r| options.ros2.robot(&cell.robots[r.0].name).is_none()).collect();
        let controllers =
            if options.simulate { Some(SimulatedControllers::start(&cell, &simulated, &shared, clock)?) } else { None };
        let web = match &options.web {
            Some(address) => {
                let feed = StatusFeed::new();
                let server = Server::watch(&cell, &feed, ServerSettings::at(address)?)?;
                Some((server, feed))
            }
            None => None,
        };
        let ros2_feed = ros2.as_ref().and_then(Participant::feed);
        let observer = if web.is_some() || recorder.is_some() || ros2_feed.is_some() {
            let feed = web.as_ref().map(|(_, feed)| feed.clone());
            Some(CellObserver::start(&cell, &shared, clock, feed, recorder, ros2_feed)?)
        } else {
            None
        };
        let server = web.map(|(server, _)| server);
        Ok(Self { controllers, ros2, nodes, arbiter, keeper, observer, server, network })
    }

    /// Number of robots that this process guards.
    pub fn guarded(&self) -> usize {
        self.nodes.len()
    }

    /// True where this process keeps the regions and grants them.
    pub fn is_arbiter(&self) -> bool {
        self.keeper.is_some()
    }

    /// True where this process grants exchange regions, of which the cell has some.
    pub fn grants_regions(&self) -> bool {
        self.arbiter.is_some()
    }

    /// Whether the simulated controllers still run; true where there are none.
    pub fn is_running(&self) -> bool {
        self.controllers.as_ref().is_none_or(SimulatedControllers::is_running)
    }

    /// The address of the page in a browser, where there is one.
    pub fn web_address(&self) -> Option<String> {
        self.server.as_ref().map(Server::url)
    }

    /// Ends everything, and completes the recording.
    ///
    /// # Errors
    /// [`ServiceError::Recording`] where it could not be written.
    pub fn stop(self) -> Result<(), ServiceError> {
        let Self { controllers, ros2, nodes, arbiter, keeper, observer, server, network } = self;
        drop((controllers, ros2, nodes, arbiter, keeper));
        let recorder = observer.and_then(CellObserver::stop);
        if let Some(server) = server {
            server.stop();
        }
        drop(network);
        recorder.map_or(Ok(()), |recorder| Ok(recorder.finish()?))
    }

    /// The network.
    pub fn network(&self) -> &Arc<ZenohNetwork> {
        &self.network
    }
}

fn start_recorder(file: &Path, cell: &Cell) -> Result<Recorder, BagError> {
    Recorder::start(CellWriter::create(file, cell, boot_number())?)
}

/// The cell as a service guards it. A controller goes on for `stale_ms` after the last override that it has heard, so that
/// stopping distances assume this much more; and regions that controllers exchange need stopping distances.
fn stopping_in_time(mut cell: Cell) -> Cell {
    let has_exchange = cell.regions.iter().any(|r| matches!(r.region.kind, RegionKind::Exchange { .. }));
    let laws = &mut cell.laws;
    if laws.stopping_reaction_s.is_none() && has_exchange {
        laws.stopping_reaction_s = Some(laws.reaction_s);
    }
    laws.stopping_reaction_s = laws.stopping_reaction_s.map(|reaction_s| reaction_s + laws.laws.stale_s);
    cell
}

fn guarded_robots(cell: &Cell, options: &ServiceOptions) -> Result<Vec<RobotId>, ServiceError> {
    if options.robots.is_empty() {
        return Ok(if options.arbiter { Vec::new() } else { (0..cell.robots.len()).map(RobotId).collect() });
    }
    let find = |name: &String| {
        let found = cell.robots.iter().position(|r| r.name == *name);
        found.map(RobotId).ok_or_else(|| ServiceError::Robot {
            name: name.clone(),
            known: cell.robots.iter().map(|r| r.name.clone()).collect(),
        })
    };
    options.robots.iter().map(find).collect()
}
