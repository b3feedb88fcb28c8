//! Options of a process of a live cell.

use std::path::PathBuf;

use elbowroom_cell::access::NetworkKey;
use elbowroom_view::http::Endpoint;

use crate::control::ControlOptions;
use crate::event_handler::EventHandler;
use crate::ros2::Ros2Settings;
use crate::sensors::FrameInput;

/// Default address of a service.
pub const DEFAULT_ADDRESS: &str = "127.0.0.1:7447";

/// Options of a process of a live cell.
#[derive(Clone, Default)]
pub struct ServiceOptions {
    /// The robots that the process guards; empty for all robots, or for none if `arbiter` is set.
    pub robots: Vec<String>,
    /// Address at which the process accepts connections.
    pub listen: Option<String>,
    /// Address to which the process connects.
    pub connect: Option<String>,
    /// Key of the cell's network: only processes with the same key are accepted.
    pub network_key: Option<NetworkKey>,
    /// Address for controllers that send UDP datagrams. Datagrams are accepted without the key.
    pub udp: Option<String>,
    /// Grants exchange regions, and keeps which regions are on.
    pub arbiter: bool,
    /// File that keeps which regions exist and which are on, to restore them at the next start
    /// ([`region_journal_of`](crate::region_journal_of)). Without it all temporary regions are on at a start.
    pub journal: Option<PathBuf>,
    /// Runs the programs of the cell file in place of the controllers.
    pub simulate: bool,
    /// Sensors whose pictures do not come from the folder of the cell file, and where they come from instead.
    pub frames: Vec<(String, FrameInput)>,
    /// Endpoint at which the cell is shown in a browser.
    pub web: Option<Endpoint>,
    /// Records everything that this process guards into this file.
    pub record: Option<PathBuf>,
    /// Serves the control interface; requires the arbiter in the same process.
    pub control: Option<ControlOptions>,
    /// Settings of the ROS 2 connection.
    pub ros2: Ros2Settings,
    /// Called with the text of every event of this process.
    pub on_event: Option<EventHandler>,
}
