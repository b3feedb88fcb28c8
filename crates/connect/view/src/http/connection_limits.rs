//! Limits of connections.

use std::time::Duration;

/// What connections may use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConnectionLimits {
    /// Open connections of those who have shown no token. One more closes the oldest of them.
    pub connections: usize,
    /// Longest time for the head of a request.
    pub head: Duration,
    /// Longest time of a request with its answer.
    pub request: Duration,
    /// Largest head of a request, bytes.
    pub head_bytes: usize,
}
