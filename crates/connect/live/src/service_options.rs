//! What a process of a live cell does.

use std::path::PathBuf;

use elbowroom_cell::seal::NetworkKey;
use elbowroom_view::http::Endpoint;

use crate::control::ControlOptions;
use crate::event_handler::EventHandler;
use crate::ros2::Ros2Settings;
use crate::sensors::FrameSource;

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
    /// Hears only those who have this key; all processes of the cell need the same.
    pub network_key: Option<NetworkKey>,
    /// Takes controllers by UDP datagrams at this address, too. They are heard without the key.
    pub udp: Option<String>,
    /// Grants exchange regions, and keeps which regions are switched on.
    pub arbiter: bool,
    /// Where it keeps which regions there are and which are on, so that they are the same when it starts again
    /// ([`region_journal_of`](crate::region_journal_of)). Without it all temporary regions are on at a start.
    pub journal: Option<PathBuf>,
    /// Runs the programs of the cell file in place of the controllers.
    pub simulate: bool,
    /// Sensors whose pictures do not come from the folder of the cell file, and where they come from instead.
    pub frames: Vec<(String, FrameSource)>,
    /// Shows the cell in a browser there.
    pub web: Option<Endpoint>,
    /// Records everything that this process guards into this file.
    pub record: Option<PathBuf>,
    /// Serves the control interface; only beside the arbiter.
    pub control: Option<ControlOptions>,
    /// What it has to do with ROS 2.
    pub ros2: Ros2Settings,
    /// Called with every event of the arbiter and the control interface of this process, in words.
    pub on_event: Option<EventHandler>,
}
