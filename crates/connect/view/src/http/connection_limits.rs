//! Limits of connections.

use std::time::Duration;

/// Limits of connections.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConnectionLimits {
    /// Open connections without a token. One more closes the oldest of them.
    pub connections: usize,
    /// Longest time for the head of a request.
    pub head: Duration,
    /// Longest time of a request with its answer.
    pub request: Duration,
    /// Largest head of a request, bytes.
    pub head_bytes: usize,
}
