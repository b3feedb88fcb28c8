//! A cell, and a client of its server.
#![allow(dead_code, reason = "every test program uses a part of it")]

pub mod drawn;

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use elbowroom_cell::Cell;
use elbowroom_view::{ClientLimits, Server, ServerSettings};
use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest as _;
use tungstenite::http::HeaderValue;
use tungstenite::{Message, WebSocket};

/// Two arms with six joints, objects around them, and every kind of region.
pub const CELL: &str = r#"
version = 1
name = "two arms"
units = { length = "mm", angle = "deg" }
tick_ms = 4
[robot.left]
dh = [
  { alpha = 90, d = 400, min = -170, max = 170, speed = 90 },
  { a = 400, min = -90, max = 90, speed = 90 },
  { alpha = 90, min = -170, max = 170, speed = 90 },
  { alpha = -90, d = 400, min = -170, max = 170, speed = 90 },
  { alpha = 90, min = -120, max = 120, speed = 90 },
  { d = 100, min = -350, max = 350, speed = 90 },
]
links = [
  { cylinder = { at = [0, -200, 0], rpy = [90, 0, 0], radius = 90, height = 380 } },
  { capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 60 } },
  [],
  { capsule = { from = [0, 250, 0], to = [0, 100, 0], radius = 50 } },
  [],
  { sphere = { at = [0, 0, 0], radius = 40 } },
]
start = [110, 30, 40, 0, 50, 0]
[robot.right]
dh = [
  { a = 500, min = -170, max = 170, speed = 90 },
  { a = 300, min = -170, max = 170, speed = 90 },
]
links = [
  { capsule = { from = [-500, 0, 0], to = [0, 0, 0], radius = 40 } },
  { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 30 } },
]
base = { at = [1600, 0, 300], rpy = [0, 0, 180] }
start = [-60, 30]
[object.table]
shape = "box"
at = [300, -900, 200]
size = [800, 500, 400]
[object.ball]
shape = "sphere"
at = [700, 700, 300]
radius = 120
[region.post]
shape = "cylinder"
base = [0, -700, 0]
radius = 100
height = 1200
warning = 300
[region.watched]
shape = "sphere"
centre = [600, 300, 900]
radius = 200
kind = "monitored"
warning = 100
[region.later]
shape = "box"
from = [900, -900, 0]
to = [1200, -600, 500]
life = "temporary"
warning = 100
[region.shared]
shape = "box"
from = [600, -250, 0]
to = [1000, 250, 900]
kind = "exchange"
warning = 150
"#;

/// Parses the cell.
pub fn cell() -> Cell {
    Cell::parse("two_arms.toml", CELL).unwrap_or_else(|e| panic!("{e}"))
}

/// Short limits, so that a test does not have to wait.
pub fn limits() -> ClientLimits {
    ClientLimits {
        head: Duration::from_millis(400),
        request: Duration::from_secs(2),
        send: Duration::from_secs(1),
        silence: Duration::from_secs(20),
        ..ClientLimits::default()
    }
}

/// Settings for any free port, with [`limits`].
pub fn settings() -> ServerSettings {
    ServerSettings { limits: limits(), ..ServerSettings::at("127.0.0.1:0").unwrap() }
}

/// Returns the token in the address of a server.
pub fn token(server: &Server) -> String {
    server.url().split_once("#token=").unwrap().1.to_owned()
}

/// Returns the answer of a server to these bytes, until it closes; empty without an answer.
pub fn answer(server: SocketAddr, request: &[u8]) -> String {
    let mut stream = TcpStream::connect(server).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(10))).unwrap();
    // A server that refuses a request closes before everything is written.
    let _ = stream.write_all(request);
    let mut bytes = Vec::new();
    let _ = stream.read_to_end(&mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Requests a path as a browser does.
pub fn get(server: SocketAddr, path: &str, headers: &str) -> String {
    answer(server, format!("GET {path} HTTP/1.1\r\nHost: {server}\r\n{headers}\r\n").as_bytes())
}

/// Parses the status of an answer; 0 if there is none.
pub fn status(answer: &str) -> u16 {
    answer.split(' ').nth(1).and_then(|word| word.parse().ok()).unwrap_or(0)
}

/// The WebSocket of a page.
pub struct Page {
    socket: WebSocket<TcpStream>,
}

/// Opens a WebSocket with these headers.
pub fn open(server: SocketAddr, host: &str, origin: Option<&str>) -> Result<Page, String> {
    let stream = TcpStream::connect(server).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
    let mut request = format!("ws://{server}/socket").into_client_request().unwrap();
    request.headers_mut().insert("host", HeaderValue::from_str(host).unwrap());
    if let Some(origin) = origin {
        request.headers_mut().insert("origin", HeaderValue::from_str(origin).unwrap());
    }
    let (socket, _) = tungstenite::client(request, stream).map_err(|e| e.to_string())?;
    Ok(Page { socket })
}

impl Page {
    /// Opens the page of a server, before its token.
    pub fn nameless(server: &Server) -> Self {
        let address = server.address();
        open(address, &address.to_string(), Some(&format!("http://{address}"))).unwrap()
    }

    /// Opens the page of a server, with its token.
    pub fn of(server: &Server) -> Self {
        let mut page = Self::nameless(server);
        page.send(&json!({ "token": token(server) }));
        assert_eq!(page.next().unwrap()["type"], "hello");
        page
    }

    pub fn send(&mut self, message: &Value) {
        self.send_raw(Message::text(message.to_string())).unwrap();
    }

    pub fn send_raw(&mut self, message: Message) -> Result<(), String> {
        self.socket.send(message).map_err(|e| e.to_string())
    }

    /// Returns the next document; `Err` with code and reason if the server has closed.
    pub fn next(&mut self) -> Result<Value, String> {
        loop {
            match self.socket.read() {
                Ok(Message::Text(text)) => return Ok(serde_json::from_str(&text).unwrap()),
                Ok(Message::Close(Some(close))) => return Err(format!("{} {}", u16::from(close.code), close.reason)),
                Ok(_) => {}
                Err(e) => return Err(e.to_string()),
            }
        }
    }

    /// Returns the next frame, which is acknowledged as shown; skips events.
    pub fn frame(&mut self) -> Result<Value, String> {
        loop {
            let document = self.next()?;
            if let Some(number) = document["number"].as_u64() {
                self.send(&json!({ "shown": number }));
                return Ok(document);
            }
        }
    }

    /// Returns the first frame that satisfies a condition.
    pub fn frame_where(&mut self, is_it: impl Fn(&Value) -> bool) -> Value {
        for _ in 0..500 {
            let frame = self.frame().unwrap();
            if is_it(&frame) {
                return frame;
            }
        }
        panic!("500 frames, and none is it");
    }
}
