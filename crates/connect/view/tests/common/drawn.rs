//! A cell in a file, whose page draws, and a client that sends what the page sends.

use std::io::{Read as _, Write as _};
use std::net::SocketAddr;
use std::path::PathBuf;

use elbowroom_cell::{Cell, CellFixture};
use elbowroom_view::{Server, ServerSettings};
use flate2::read::GzDecoder;
use serde_json::{Value, json};

use super::{status, token};

/// A skull, a mill beside it, a ball, and a fixture that exists.
const CELL: &str = r#"# A skull is opened.
version = 1
name = "drawn"
units = { length = "mm", angle = "deg" }
[robot.arm]
model = "MODELS/rx60b/rx60b.urdf"
srdf = "MODELS/rx60b/rx60b.srdf"
base = { at = [-400, 0, 0] }
[robot.arm.tool]
tcp = { at = [0, 0, 140] }
mesh = "MODELS/tools/mill.stl"
[object.skull]
shape = "mesh"
mesh = "MODELS/work_pieces/skull.stl"
at = [430, 0, 240]
[object.ball]
shape = "sphere"
radius = 30
at = [430, 300, 240]
[object.floor]
shape = "plane"
[fixture.first]
protects = "ball"       # stays
target = { faces_within = { at = [430, 300, 270], radius = 8 } }
width = 5
tolerance = 4
"#;

pub struct Drawn {
    folder: tempfile::TempDir,
    pub server: Server,
}

impl Drawn {
    pub fn new(settings: ServerSettings) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let models = elbowroom_testkit::folder::examples().join("models");
        let file = folder.path().join("cell.toml");
        std::fs::write(&file, CELL.replace("MODELS", &models.display().to_string())).unwrap();
        let cell = Cell::load(&file).unwrap_or_else(|e| panic!("{e}"));
        Self { server: Server::draw(&cell, settings).unwrap(), folder }
    }

    pub fn file(&self) -> PathBuf {
        self.folder.path().join("cell.toml")
    }

    pub fn text(&self) -> String {
        std::fs::read_to_string(self.file()).unwrap()
    }

    pub fn load(&self) -> Cell {
        Cell::load(self.file()).unwrap_or_else(|e| panic!("{e}"))
    }

    /// Sends a document as the page does; status and answer.
    pub fn post(&self, path: &str, body: &str) -> (u16, Vec<u8>) {
        let (address, token) = (self.server.address(), token(&self.server));
        self.send(
            path,
            &format!("Origin: http://{address}\r\nAuthorization: Bearer {token}\r\nContent-Type: application/json\r\n"),
            body,
        )
    }

    pub fn send(&self, path: &str, headers: &str, body: &str) -> (u16, Vec<u8>) {
        let address = self.server.address();
        let head =
            format!("POST {path} HTTP/1.1\r\nHost: {address}\r\n{headers}Content-Length: {}\r\n\r\n", body.len());
        split(&exchange(address, (head + body).as_bytes()))
    }

    pub fn ask(&self, path: &str, body: &Value) -> (u16, Value) {
        let (status, body) = self.post(path, &body.to_string());
        (status, serde_json::from_slice(&body).unwrap_or_else(|_| String::from_utf8_lossy(&body).into_owned().into()))
    }

    /// The document of a preview.
    pub fn preview(&self, drawn: &Value) -> Value {
        let (status, body) = self.post("/draw/preview", &drawn.to_string());
        assert_eq!(status, 200, "{}", String::from_utf8_lossy(&body));
        let mut data = Vec::new();
        GzDecoder::new(&body[..]).read_to_end(&mut data).unwrap();
        let length = u32::from_le_bytes(data[..4].try_into().unwrap()) as usize;
        serde_json::from_slice(&data[4..4 + length]).unwrap()
    }

    /// The point of an object below a place, as a click from above finds it.
    pub fn below(&self, object: &str, x: f64, y: f64) -> [f64; 3] {
        let (status, hit) =
            self.ask("/draw/pick", &json!({ "object": object, "origin_m": [x, y, 3.0], "direction": [0, 0, -2] }));
        assert_eq!(status, 200, "{hit}");
        serde_json::from_value(hit["point_m"].clone()).unwrap()
    }
}

/// Bytes of an answer, until the server closes.
fn exchange(server: SocketAddr, request: &[u8]) -> Vec<u8> {
    let mut stream = std::net::TcpStream::connect(server).unwrap();
    stream.set_read_timeout(Some(std::time::Duration::from_mins(2))).unwrap();
    // A server that refuses a request closes before everything is written.
    let _ = stream.write_all(request);
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    bytes
}

/// Status and body of an answer; status 0 without one.
pub fn split(answer: &[u8]) -> (u16, Vec<u8>) {
    let end = answer.windows(4).position(|w| w == b"\r\n\r\n").unwrap_or(answer.len());
    (status(&String::from_utf8_lossy(&answer[..end])), answer.get(end + 4..).unwrap_or_default().to_vec())
}

pub fn fixture<'c>(cell: &'c Cell, name: &str) -> &'c CellFixture {
    cell.guidance.fixtures.iter().find(|f| f.name == name).unwrap()
}
