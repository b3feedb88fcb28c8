//! Settings of the server.

use std::net::SocketAddr;
use std::time::Duration;

use crate::ViewError;
use crate::http::{ConnectionLimits, loopback_address};

/// Where a [`Server`](crate::Server) serves, and what it grants its clients.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ServerSettings {
    /// A loopback address; port 0 takes any free one.
    pub address: SocketAddr,
    /// What clients may use.
    pub limits: Limits,
}

/// What the clients of a server may use. A client beyond a limit is refused or closed; the others do not notice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Connections that are not yet browsers with a token. One more closes the oldest of them.
    pub connections: usize,
    /// Browsers with a token. One more is refused.
    pub browsers: usize,
    /// Longest time for the head of a request, and for the first message of a WebSocket.
    pub head: Duration,
    /// Longest time of a request with its answer.
    pub request: Duration,
    /// Longest time until a browser takes a message.
    pub send: Duration,
    /// Longest silence of a browser; it is pinged three times as often.
    pub silence: Duration,
    /// Largest head of a request, bytes.
    pub head_bytes: usize,
    /// Largest message of a browser, bytes.
    pub message_bytes: usize,
    /// Shortest time between two frames.
    pub frame_period: Duration,
    /// Frames that a browser may have received without having shown them.
    pub unshown_frames: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            connections: 256,
            browsers: 16,
            head: Duration::from_secs(5),
            request: Duration::from_secs(30),
            send: Duration::from_secs(10),
            silence: Duration::from_secs(30),
            head_bytes: 16 * 1024,
            message_bytes: 16 * 1024,
            frame_period: Duration::from_micros(16_667),
            unshown_frames: 3,
        }
    }
}

impl Limits {
    /// Of connections without a token.
    pub(crate) fn of_connections(&self) -> ConnectionLimits {
        let Self { connections, head, request, head_bytes, .. } = *self;
        ConnectionLimits { connections, head, request, head_bytes }
    }
}

impl ServerSettings {
    /// For the text of an option: `127.0.0.1:8080`, `localhost:8080`, `[::1]:8080`, or a port alone.
    ///
    /// ```
    /// use elbowroom_view::{ServerSettings, ViewError};
    /// assert_eq!(ServerSettings::at("localhost:8080")?.address, "127.0.0.1:8080".parse().unwrap());
    /// assert_eq!(ServerSettings::at("8080")?, ServerSettings::at("127.0.0.1:8080")?);
    /// let error = ServerSettings::at("0.0.0.0:8080").unwrap_err();
    /// assert!(matches!(error, ViewError::NotLoopback(_)) && error.to_string().contains("ssh -L 8080"));
    /// assert!(matches!(ServerSettings::at("cell.local"), Err(ViewError::NoAddress(_))));
    /// # Ok::<(), ViewError>(())
    /// ```
    ///
    /// # Errors
    /// [`ViewError::NoAddress`], or [`ViewError::NotLoopback`] for an address that other computers reach.
    pub fn at(text: &str) -> Result<Self, ViewError> {
        let address = loopback_address(text)?;
        Ok(Self { address, limits: Limits::default() })
    }
}
