//! Parts of a process of a live cell, in the order in which they start.

use std::sync::{Arc, mpsc};
use std::time::Duration;

use elbowroom_cell::configure::MonitorSetup;
use elbowroom_cell::{Cell, EditedRegions, configure};
use elbowroom_interlock::{Boot, Micros};
use elbowroom_monitor::{Life, RegionKind};
use elbowroom_recording::{BagError, CellWriter, Recorder};
use elbowroom_robot::RobotId;
use elbowroom_view::{Server, ServerSettings, StatusFeed};

use crate::arbiter_service::ArbiterService;
use crate::cell_observer::CellObserver;
use crate::cell_versions::CellVersions;
use crate::clock::{Clock, boot_number};
use crate::control::{ControlParts, ControlServer, JointsHeard, NodesHeard};
use crate::event_handler::EventHandler;
use crate::keys::Keys;
use crate::measured_sources::MeasuredSources;
use crate::network::{
    AuthenticatedNetwork, JoinedNetworks, Network, NetworkError, UdpNetwork, ZenohNetwork, ZenohSettings,
};
use crate::node::{Node, NodeParts};
use crate::peer_watch::PeerWatch;
use crate::region_journal::{JournalError, RegionJournal};
use crate::region_keeper::{ProgramSwitches, RegionKeeper};
use crate::robot_claims::RobotClaims;
use crate::ros2::{CellFeed, Participant};
use crate::sensors::{check_frames, unguarded};
use crate::service_error::ServiceError;
use crate::service_options::{DEFAULT_ADDRESS, ServiceOptions};
use crate::simulated_controllers::SimulatedControllers;
use crate::simulated_sources::SimulatedSources;

/// Time after which a missing answer of the other process is reported.
const NOBODY: Duration = Duration::from_secs(2);

/// Data that all parts share.
pub(crate) struct ServiceStart<'o> {
    options: &'o ServiceOptions,
    cell: Arc<Cell>,
    versions: Arc<CellVersions>,
    /// The robots that this process guards.
    robots: Vec<RobotId>,
    pub(crate) zenoh: Arc<ZenohNetwork>,
    shared: Arc<dyn Network>,
    /// Network of the controllers: includes UDP datagrams if an address is given for them.
    of_controllers: Arc<dyn Network>,
    clock: Clock,
}

impl<'o> ServiceStart<'o> {
    /// Opens the networks.
    pub(crate) fn new(cell: Cell, options: &'o ServiceOptions) -> Result<Self, ServiceError> {
        // A cell that was not read from a file cannot have edited regions.
        let edited = EditedRegions::read(&cell).ok();
        let cell = Arc::new(stopping_in_time(cell));
        let versions = Arc::new(CellVersions::new(&cell, edited, stopping_in_time));
        let robots = guarded_robots(&cell, options)?;
        let listen = match (&options.listen, &options.connect) {
            (None, None) => Some(DEFAULT_ADDRESS.to_owned()),
            (listen, _) => listen.clone(),
        };
        let settings = ZenohSettings { listen, connect: options.connect.clone() };
        let zenoh = Arc::new(patiently(&settings, options.on_event.as_ref(), || ZenohNetwork::open(&settings))?);
        let shared = shared_network(&zenoh, &cell, options)?;
        let of_controllers = with_udp(&shared, options.udp.as_deref())?;
        Ok(Self { options, cell, versions, robots, zenoh, shared, of_controllers, clock: Clock::start() })
    }

    /// Whether this process keeps the regions: as the arbiter, or as the only process.
    fn keeps_regions(&self) -> bool {
        self.options.arbiter || self.options.robots.is_empty()
    }

    pub(crate) fn keeper(&self) -> Result<Option<Arc<RegionKeeper>>, ServiceError> {
        if !self.keeps_regions() {
            return Ok(None);
        }
        let programs = program_switches(self.options);
        // If nobody can switch or edit regions, there is nothing to keep, and no file to lock.
        let can_change =
            self.options.control.is_some() || self.cell.regions.iter().any(|r| r.region.life == Life::Temporary);
        let journal = self.options.journal.as_deref().filter(|journal| can_change || journal.exists());
        let journal = journal.ok_or(JournalError::NotKept).and_then(RegionJournal::open);
        let on_event = self.options.on_event.clone();
        let keeper = RegionKeeper::start(
            &self.versions,
            (&self.shared, self.clock),
            boot_number(),
            programs,
            journal,
            on_event,
        )?;
        Ok(Some(Arc::new(keeper)))
    }

    pub(crate) fn arbiter(&self) -> Result<Option<Arc<ArbiterService>>, ServiceError> {
        if !self.keeps_regions() {
            return Ok(None);
        }
        let on_event = self.options.on_event.clone();
        Ok(ArbiterService::start(&self.cell, &self.shared, boot_number(), self.clock, on_event)?.map(Arc::new))
    }

    pub(crate) fn control(
        &self,
        keeper: Option<&Arc<RegionKeeper>>,
        arbiter: Option<&Arc<ArbiterService>>,
    ) -> Result<Option<ControlServer>, ServiceError> {
        let Some(control) = &self.options.control else { return Ok(None) };
        let keeper = keeper.ok_or(ServiceError::ControlWithoutArbiter)?;
        let parts = ControlParts {
            versions: self.versions.clone(),
            keeper: keeper.clone(),
            arbiter: arbiter.cloned(),
            nodes: NodesHeard::start(&self.cell, &self.shared, self.clock)?,
            joints: JointsHeard::start(&self.cell, &self.of_controllers, self.clock, Micros(0))?,
            measured: MeasuredSources::start(&self.cell, &self.of_controllers, self.clock)?,
            clock: self.clock,
            on_event: self.options.on_event.clone(),
        };
        keeper.allow_edits();
        Ok(Some(ControlServer::start(parts, control)?))
    }

    pub(crate) fn recorder(&self) -> Result<Option<Recorder>, ServiceError> {
        let Some(file) = &self.options.record else { return Ok(None) };
        if file.exists() {
            // Never overwrite a recording: it cannot be repeated.
            return Err(BagError::Exists(file.clone()).into());
        }
        let on_event = self.options.on_event.clone();
        let on_error = move |e: &BagError| {
            if let Some(on_event) = on_event {
                on_event(&format!(
                    "--record: {e}\n  nothing is recorded from here on; the robots are guarded as before"
                ));
            }
        };
        Ok(Some(Recorder::start(CellWriter::create(file, &self.cell, boot_number())?, on_error)?))
    }

    /// Claims the robots of this process until its nodes run.
    ///
    /// # Errors
    /// [`ServiceError::GuardedAlready`] if another process guards one of them.
    pub(crate) fn claims(&self) -> Result<RobotClaims, ServiceError> {
        let names: Vec<&str> = self.robots.iter().map(|robot| &self.cell.robots[robot.0].name[..]).collect();
        RobotClaims::new(&self.shared, &Keys::new(&self.cell.name), &names, boot_number())
    }

    /// Starts the nodes, unless another process has claimed their robots in the meantime.
    pub(crate) fn nodes(
        &self,
        recorder: Option<&Recorder>,
        mut claims: RobotClaims,
    ) -> Result<Vec<Node>, ServiceError> {
        let setups = configure::setups(&self.cell)?.into_iter().enumerate();
        claims.settle()?;
        let guarded = setups.filter(|(i, _)| self.robots.contains(&RobotId(*i)));
        guarded.map(|(i, setup)| self.node(RobotId(i), setup, recorder)).collect()
    }

    fn node(&self, robot: RobotId, setup: MonitorSetup, recorder: Option<&Recorder>) -> Result<Node, ServiceError> {
        let networks = [self.of_controllers.clone(), self.shared.clone()];
        let parts = NodeParts::new(&self.cell, (robot, setup), Boot(boot_number()), self.clock, networks)?;
        let recorder = recorder.map(|r| r.robot(robot.0 as u32, parts.monitor.monitor(), self.clock.seconds()));
        Ok(Node::start(NodeParts { recorder, versions: Some(self.versions.clone()), ..parts })?)
    }

    pub(crate) fn ros2(&self) -> Result<Option<Participant>, ServiceError> {
        let on_event = self.options.on_event.clone();
        let settings = &self.options.ros2;
        Ok(Participant::start(&self.cell, settings, &self.robots, &self.shared, self.clock, on_event)?)
    }

    /// Sends the measured sources in place of those who measure them, if this process keeps the regions and simulates.
    pub(crate) fn simulated_sources(&self) -> Result<Option<SimulatedSources>, ServiceError> {
        if !self.options.simulate || !self.keeps_regions() {
            return Ok(None);
        }
        Ok(SimulatedSources::start(&self.cell, &self.of_controllers, self.clock)?)
    }

    /// Starts simulated controllers for all robots of this process, except for robots whose controllers use ROS 2.
    pub(crate) fn simulated_controllers(&self) -> Result<Option<SimulatedControllers>, ServiceError> {
        let is_real = |robot: &RobotId| self.options.ros2.robot(&self.cell.robots[robot.0].name).is_some();
        let is_simulated = |robot: &RobotId| self.options.simulate && !is_real(robot);
        let robots: Vec<RobotId> = self.robots.iter().copied().filter(is_simulated).collect();
        if let Some(on_event) = &self.options.on_event {
            let real = self.robots.iter().copied().filter(|robot| !is_simulated(robot));
            unguarded(&self.cell, real).for_each(|warning| on_event(&warning));
        }
        check_frames(&self.cell, &robots, &self.options.frames)?;
        if !self.options.simulate {
            return Ok(None);
        }
        let (networks, context) = ((&self.shared, &self.of_controllers), (self.clock, self.options.on_event.clone()));
        Ok(Some(SimulatedControllers::start(&self.cell, &robots, &self.options.frames, networks, context)?))
    }

    /// Starts the report of other processes that come and go.
    pub(crate) fn peers(&self) -> Result<PeerWatch, NetworkError> {
        let on_event = self.options.on_event.clone();
        PeerWatch::start(&self.cell, &self.robots, self.keeps_regions(), &self.zenoh, on_event)
    }

    /// Starts the page in a browser; returns it with its feed.
    pub(crate) fn web(&self) -> Result<Option<(Server, StatusFeed)>, ServiceError> {
        let Some(endpoint) = &self.options.web else { return Ok(None) };
        let feed = StatusFeed::new();
        Ok(Some((Server::watch(&self.cell, &feed, ServerSettings::new(endpoint.clone()))?, feed)))
    }

    /// Starts the observer of the whole cell, if the page, a recorder or ROS 2 needs it.
    pub(crate) fn observer(
        &self,
        page: Option<StatusFeed>,
        recorder: Option<Recorder>,
        ros2: Option<CellFeed>,
    ) -> Result<Option<CellObserver>, ServiceError> {
        if page.is_none() && recorder.is_none() && ros2.is_none() {
            return Ok(None);
        }
        Ok(Some(CellObserver::start(
            &self.cell,
            [&self.shared, &self.of_controllers],
            self.clock,
            page,
            recorder,
            ros2,
        )?))
    }
}

/// Returns the network that all processes of the cell share; with a key, only processes that have the key.
fn shared_network(
    zenoh: &Arc<ZenohNetwork>,
    cell: &Cell,
    options: &ServiceOptions,
) -> Result<Arc<dyn Network>, NetworkError> {
    let Some(key) = &options.network_key else { return Ok(zenoh.clone()) };
    let (prefix, on_event) = (Keys::new(&cell.name).prefix(), options.on_event.clone());
    Ok(Arc::new(AuthenticatedNetwork::new(zenoh.clone(), key, &prefix, on_event)?))
}

/// Opens a network, and reports after [`NOBODY`] that the other process does not answer.
fn patiently<T>(settings: &ZenohSettings, on_event: Option<&EventHandler>, open: impl FnOnce() -> T) -> T {
    let (Some(address), Some(on_event)) = (settings.connect.clone(), on_event.cloned()) else { return open() };
    let (opened, is_open) = mpsc::channel::<()>();
    let remind = move || {
        if is_open.recv_timeout(NOBODY) == Err(mpsc::RecvTimeoutError::Timeout) {
            on_event(&format!(
                "nobody answers at {address} yet\n  help: start the process that listens there, as `live CELL --arbiter --listen {address}`"
            ));
        }
    };
    let _ = std::thread::Builder::new().name("connects".into()).spawn(remind);
    let result = open();
    drop(opened);
    result
}

/// Programs may switch regions if there is no control interface with tokens, or if that is allowed.
fn program_switches(options: &ServiceOptions) -> ProgramSwitches {
    match &options.control {
        Some(control) if !control.program_switches => ProgramSwitches::Ignored(options.on_event.clone()),
        _ => ProgramSwitches::Obeyed,
    }
}

/// Returns the network of the controllers: with UDP datagrams if an address is given for them.
fn with_udp(zenoh: &Arc<dyn Network>, address: Option<&str>) -> Result<Arc<dyn Network>, NetworkError> {
    let Some(address) = address else { return Ok(zenoh.clone()) };
    Ok(Arc::new(JoinedNetworks::new(vec![zenoh.clone(), Arc::new(UdpNetwork::bind(address, &[])?)])))
}

/// Adapts the cell to a service. A controller continues for `stale_ms` after the last override that it received, so
/// stopping distances assume that much more reaction time; cells with exchange regions always use stopping distances.
pub(crate) fn stopping_in_time(mut cell: Cell) -> Cell {
    let has_exchange = cell.regions.iter().any(|r| matches!(r.region.kind, RegionKind::Exchange { .. }));
    let laws = &mut cell.monitoring;
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
