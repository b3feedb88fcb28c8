//! Interface of every network: publish and subscribe.

use std::fmt;

use thiserror::Error;

/// A network of processes, without guarantees: a message may be lost, late, doubled or reordered.
pub trait Network: Send + Sync + fmt::Debug {
    /// Creates a publisher of one key.
    ///
    /// # Errors
    /// The key is not accepted, or the network is closed.
    fn publisher(&self, key: &str, urgency: Urgency) -> Result<Box<dyn Publisher>, NetworkError>;

    /// Calls the handler with every message of a key, on a thread of the network, until the subscription is dropped.
    /// The handler must return soon.
    ///
    /// # Errors
    /// The key is not accepted, or the network is closed.
    fn subscribe(&self, key: &str, handler: Handler) -> Result<Subscription, NetworkError>;
}

/// Publishes the messages of one key.
pub trait Publisher: Send {
    /// Sends a message, without a reply and without a guarantee.
    fn publish(&mut self, bytes: &[u8]);
}

/// Called with the bytes of each message.
pub type Handler = Box<dyn Fn(&[u8]) + Send + Sync>;

/// A subscription. It ends when it is dropped.
pub struct Subscription(#[allow(dead_code, reason = "held for its drop")] Box<dyn std::any::Any + Send + Sync>);

impl fmt::Debug for Subscription {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Subscription")
    }
}

impl Subscription {
    pub(crate) fn new(guard: impl Send + Sync + 'static) -> Self {
        Self(Box::new(guard))
    }
}

/// Priority of a message if a network cannot send everything at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Urgency {
    /// Overrides, joint states and interlocks: sent at once.
    RealTime,
    /// Information for people.
    Display,
}

/// Errors of a network.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum NetworkError {
    /// An address that cannot be used.
    #[error("{address}: {why}\n  help: write HOST:PORT, such as 127.0.0.1:7447")]
    Address {
        /// The address as it was given.
        address: String,
        /// The reason.
        why: String,
    },
    /// An address at which another program listens.
    #[error("{address}: another program listens there\n  help: another port, or end that program")]
    InUse {
        /// The address as it was given.
        address: String,
    },
    /// A key that cannot be used.
    #[error("the key {key}: {why}")]
    Key {
        /// The key.
        key: String,
        /// The reason.
        why: String,
    },
}
