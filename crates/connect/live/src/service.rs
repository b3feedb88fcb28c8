//! Process of a live cell: nodes, arbiter and simulated controllers, in any combination.

use std::net::SocketAddr;
use std::sync::Arc;

use elbowroom_cell::Cell;
use elbowroom_view::Server;

use crate::arbiter_service::ArbiterService;
use crate::cell_observer::CellObserver;
use crate::control::ControlServer;
use crate::network::ZenohNetwork;
use crate::node::Node;
use crate::peer_watch::PeerWatch;
use crate::region_keeper::RegionKeeper;
use crate::ros2::Participant;
use crate::service_error::ServiceError;
use crate::service_options::ServiceOptions;
use crate::service_start::ServiceStart;
use crate::simulated_controllers::SimulatedControllers;
use crate::simulated_sources::SimulatedSources;

/// A running process of a live cell; it ends when it is dropped.
pub struct Service {
    // In the order in which the parts end: controllers stop first.
    controllers: Option<SimulatedControllers>,
    sources: Option<SimulatedSources>,
    ros2: Option<Participant>,
    nodes: Vec<Node>,
    control: Option<ControlServer>,
    arbiter: Option<Arc<ArbiterService>>,
    keeper: Option<Arc<RegionKeeper>>,
    observer: Option<CellObserver>,
    peers: PeerWatch,
    server: Option<Server>,
    network: Arc<ZenohNetwork>,
}

impl Service {
    /// Starts the parts that the options name.
    ///
    /// # Errors
    /// [`ServiceError`]; then nothing runs.
    pub fn start(cell: Cell, options: &ServiceOptions) -> Result<Self, ServiceError> {
        let begin = ServiceStart::new(cell, options)?;
        let claims = begin.claims()?;
        let keeper = begin.keeper()?;
        let arbiter = begin.arbiter()?;
        let control = begin.control(keeper.as_ref(), arbiter.as_ref())?;
        let recorder = begin.recorder()?;
        let nodes = begin.nodes(recorder.as_ref(), claims)?;
        let ros2 = begin.ros2()?;
        let sources = begin.simulated_sources()?;
        let controllers = begin.simulated_controllers()?;
        let peers = begin.peers()?;
        let (server, feed) = begin.web()?.unzip();
        let observer = begin.observer(feed, recorder, ros2.as_ref().and_then(Participant::feed))?;
        Ok(Self {
            controllers,
            sources,
            ros2,
            nodes,
            control,
            arbiter,
            keeper,
            observer,
            peers,
            server,
            network: begin.zenoh,
        })
    }

    /// Number of robots that this process guards.
    pub fn guarded(&self) -> usize {
        self.nodes.iter().filter(|node| node.is_guard()).count()
    }

    /// Number of mechanisms whose joint values this process reads and shows.
    pub fn mechanisms(&self) -> usize {
        self.nodes.len() - self.guarded()
    }

    /// Whether this process keeps the regions and grants exchange regions.
    pub fn is_arbiter(&self) -> bool {
        self.keeper.is_some()
    }

    /// Whether the simulated controllers still run; true if there are none.
    pub fn is_running(&self) -> bool {
        self.controllers.as_ref().is_none_or(SimulatedControllers::is_running)
    }

    /// Address of the page in a browser, if it is served.
    pub fn web_address(&self) -> Option<String> {
        self.server.as_ref().map(Server::url)
    }

    /// Address of the control interface, if it is served.
    pub fn control_address(&self) -> Option<SocketAddr> {
        self.control.as_ref().map(ControlServer::address)
    }

    /// Ends all parts, and completes the recording.
    ///
    /// # Errors
    /// [`ServiceError::Recording`] if the recording could not be written.
    pub fn stop(self) -> Result<(), ServiceError> {
        let Self { controllers, sources, ros2, nodes, control, arbiter, keeper, observer, peers, server, network } =
            self;
        drop((peers, controllers, sources, ros2, nodes, control, arbiter, keeper));
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
