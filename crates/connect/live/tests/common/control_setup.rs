//! Service with a control interface, and its clients.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use elbowroom_cell::Cell;
use elbowroom_cell::access::{AccessTokens, ControlEntry, control_history, control_log_of};
use elbowroom_live::network::ZenohNetwork;
use elbowroom_live::{ControlOptions, RegionTable, Service, ServiceOptions, region_journal_of};
use elbowroom_monitor::AccessClass;
use elbowroom_testkit::network::free_address;
use elbowroom_view::http::Endpoint;
use serde_json::Value;

/// Two rails side by side, with a region that both enter, one that is switched, and a permanent one. Arguments: the x
/// of the second rail, and the centre of the region that both enter, mm.
macro_rules! rails {
    ($x:literal, $pallet:literal) => {
        concat!(
            r#"
version = 1
name = "rails"
units = { length = "mm", angle = "deg" }
[robot.left]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
links = [{ sphere = { radius = 50 } }]
[robot.right]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
links = [{ sphere = { radius = 50 } }]
base = { at = ["#,
            $x,
            r#", 0, 0] }
[region.pallet]
shape = "sphere"
centre = ["#,
            $pallet,
            r#"]
radius = 200
kind = "exchange"
warning = 100
[region.cart]
shape = "sphere"
centre = [0, 0, 1700]
radius = 100
life = "temporary"
warning = 100
[region.wall]
shape = "sphere"
centre = [0, 900, 0]
radius = 100
warning = 100
"#
        )
    };
}
pub(crate) use rails;

/// Indices of the secrets.
pub const OPERATOR: usize = 0;
pub const PROGRAMMER: usize = 1;
pub const INTEGRATOR: usize = 2;

/// A service of a cell whose robots are controlled by the test, or silent.
pub struct ControlSetup {
    pub folder: tempfile::TempDir,
    /// Address of the control interface.
    pub address: SocketAddr,
    /// Address of the network.
    pub listen: String,
    pub secrets: [String; 3],
    pub events: Arc<Mutex<Vec<String>>>,
    pub cell: Cell,
    options: ServiceOptions,
    /// The service; `None` after it was stopped.
    pub service: Option<Service>,
}

impl ControlSetup {
    /// Starts a service with `options`, of a cell file with this text.
    pub fn new(text: &str, program_switches: bool, options: ServiceOptions) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let (file, tokens) = (folder.path().join("cell.toml"), folder.path().join("tokens.toml"));
        std::fs::write(&file, text).unwrap();
        let classes = [AccessClass::Operator, AccessClass::Programmer, AccessClass::Integrator];
        let secrets = classes.map(|class| AccessTokens::add(&tokens, class, class.name()).unwrap());
        let cell = Cell::load(&file).unwrap_or_else(|e| panic!("{e}"));
        let events: Arc<Mutex<Vec<String>>> = Arc::default();
        let (heard, listen) = (events.clone(), free_address());
        let endpoint = Endpoint::new("127.0.0.1:0", None).unwrap();
        // The journal of a service that ended with all temporary regions off.
        let journal = region_journal_of(&file);
        let table = RegionTable::initial(&cell).message(&cell);
        std::fs::write(&journal, serde_json::to_vec(&table).unwrap()).unwrap();
        let options = ServiceOptions {
            journal: Some(journal),
            listen: Some(listen.clone()),
            control: Some(ControlOptions { endpoint, tokens, log: None, program_switches }),
            on_event: Some(Arc::new(move |event: &str| heard.lock().unwrap().push(event.to_owned()))),
            ..options
        };
        let service = Service::start(cell.clone(), &options).unwrap_or_else(|e| panic!("{e}"));
        let address = service.control_address().unwrap();
        Self { folder, address, listen, secrets, events, cell, options, service: Some(service) }
    }

    /// Ends the service and starts it again.
    pub fn restart(&mut self) {
        drop(self.service.take());
        let service = Service::start(self.cell.clone(), &self.options).unwrap_or_else(|e| panic!("{e}"));
        self.address = service.control_address().unwrap();
        self.service = Some(service);
    }

    /// Returns the logged changes since the start.
    pub fn changes(&self) -> Vec<ControlEntry> {
        let mut entries = self.logged();
        let start = entries.remove(0);
        assert_eq!((start.sequence, start.action.as_str(), start.name.as_str()), (1, "start", "the service"));
        entries
    }

    /// Returns all log entries.
    pub fn logged(&self) -> Vec<ControlEntry> {
        control_history(&control_log_of(&self.cell.file)).unwrap().entries
    }

    pub fn network(&self) -> Arc<ZenohNetwork> {
        self.service.as_ref().unwrap().network().clone()
    }

    /// Returns the answer of the server to these bytes.
    pub fn answer(&self, bytes: &[u8]) -> String {
        let mut stream = TcpStream::connect(self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
        // A server that refuses a request closes before everything is written.
        let _ = stream.write_all(bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        String::from_utf8_lossy(&answer).into_owned()
    }

    pub fn request(&self, method: &str, path: &str, headers: &str, body: &str) -> (u16, Value) {
        let (host, length) = (self.address, body.len());
        let head = format!("{method} {path} HTTP/1.1\r\nHost: {host}\r\n{headers}Content-Length: {length}\r\n\r\n");
        read(&self.answer((head + body).as_bytes()))
    }

    pub fn bearer(&self, class: usize) -> String {
        format!("Authorization: Bearer {}\r\n", self.secrets[class])
    }

    pub fn regions(&self) -> Value {
        let (status, document) = self.request("GET", "/regions", &self.bearer(OPERATOR), "");
        assert_eq!(status, 200, "{document}");
        document
    }

    pub fn region(&self, name: &str) -> Option<Value> {
        self.regions()["regions"].as_array().unwrap().iter().find(|r| r["name"] == name).cloned()
    }

    pub fn revision(&self) -> String {
        self.regions()["revision"].as_str().unwrap().to_owned()
    }

    /// Requests a change at a revision.
    pub fn change_at(&self, class: usize, path: &str, revision: &str, body: &Value) -> (u16, Value) {
        let headers = format!("{}If-Match: \"{revision}\"\r\nContent-Type: application/json\r\n", self.bearer(class));
        self.request("POST", path, &headers, &body.to_string())
    }

    pub fn change(&self, class: usize, path: &str, body: &Value) -> (u16, Value) {
        self.change_at(class, path, &self.revision(), body)
    }
}

/// Parses status and document of an answer; status 0 if there is none.
pub fn read(answer: &str) -> (u16, Value) {
    let (head, body) = answer.split_once("\r\n\r\n").unwrap_or((answer, ""));
    let status = head.split(' ').nth(1).and_then(|word| word.parse().ok()).unwrap_or(0);
    (status, serde_json::from_str(body).unwrap_or_default())
}
