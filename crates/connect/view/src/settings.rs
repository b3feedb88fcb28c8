//! Settings of the server.

use std::time::Duration;

use crate::ViewError;
use crate::http::{ConnectionLimits, Endpoint};

/// Endpoint of a [`Server`](crate::Server), and the limits of its clients.
#[derive(Debug, Clone)]
pub struct ServerSettings {
    /// Endpoint at which it serves.
    pub endpoint: Endpoint,
    /// Limits of the clients.
    pub limits: ClientLimits,
}

/// Limits of a server's clients. A client beyond a limit is refused or closed, without effect on the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClientLimits {
    /// Connections that are not yet browsers with a token. One more closes the oldest of them.
    pub connections: usize,
    /// Browsers with a token. One more is refused.
    pub browsers: usize,
    /// Longest time for the head of a request, and for the first message of a WebSocket.
    pub head: Duration,
    /// Longest time of a request with its answer.
    pub request: Duration,
    /// Longest time until a browser accepts a message.
    pub send: Duration,
    /// Longest silence of a browser; it is pinged at three times this rate.
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

impl Default for ClientLimits {
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

impl ClientLimits {
    /// Limits of connections without a token.
    pub(crate) fn of_connections(&self) -> ConnectionLimits {
        let Self { connections, head, request, head_bytes, .. } = *self;
        ConnectionLimits { connections, head, request, head_bytes }
    }
}

impl ServerSettings {
    /// Creates settings with the default limits.
    pub fn new(endpoint: Endpoint) -> Self {
        Self { endpoint, limits: ClientLimits::default() }
    }

    /// Creates settings without encryption, for the value of an option: `127.0.0.1:8080`, `localhost:8080`,
    /// `[::1]:8080`, or a port alone.
    ///
    /// # Errors
    /// As [`Endpoint::new`] without a certificate.
    pub fn at(text: &str) -> Result<Self, ViewError> {
        Endpoint::new(text, None).map(Self::new)
    }
}
