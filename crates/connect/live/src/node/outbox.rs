//! Messages that a node has to send.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use elbowroom_interlock::wire::MAX_BYTES;
use elbowroom_monitor::Monitor;
use elbowroom_status::{HealthStatus, StatusSample};

use super::doubt::Doubt;
use super::next_configuration::NodeVersion;
use crate::locked::locked;
use crate::messages::OverrideAnswer;

/// Messages from the tick's thread to the sending thread. A message that is not sent yet is replaced by the next one.
#[derive(Debug)]
pub(super) struct Outbox {
    contents: Mutex<Outgoing>,
    news: Condvar,
}

#[derive(Debug)]
pub(super) struct Outgoing {
    pub(super) answer: Option<OverrideAnswer>,
    /// The guard's message to the arbiter; empty if there is none.
    pub(super) state: Vec<u8>,
    /// Data of the last tick, valid if `has_sample`.
    pub(super) sample: StatusSample,
    pub(super) has_sample: bool,
    /// The configuration of that tick.
    pub(super) version: Arc<NodeVersion>,
    pub(super) t_s: f64,
    pub(super) sequence: u64,
    /// Revision of the table of regions of that tick.
    pub(super) table: (u64, u64),
    pub(super) health: HealthStatus,
    /// Fault in the input of the node.
    pub(super) doubt: Option<Doubt>,
    pub(super) is_closed: bool,
}

impl Outgoing {
    fn is_empty(&self) -> bool {
        self.answer.is_none() && self.state.is_empty() && !self.has_sample && !self.is_closed
    }

    /// Exchanges `into` with the sample, if it is new; returns its time in s, its sequence number and the health.
    pub(super) fn take_sample(&mut self, into: &mut StatusSample) -> Option<(f64, u64, HealthStatus)> {
        if !std::mem::take(&mut self.has_sample) {
            return None;
        }
        std::mem::swap(into, &mut self.sample);
        Some((self.t_s, self.sequence, self.health))
    }
}

impl Outbox {
    pub(super) fn new(monitor: &Monitor, version: Arc<NodeVersion>) -> Self {
        let contents = Outgoing {
            answer: None,
            state: Vec::with_capacity(MAX_BYTES),
            sample: StatusSample::new(monitor),
            has_sample: false,
            version,
            t_s: 0.0,
            sequence: 0,
            table: (0, 0),
            health: HealthStatus::default(),
            doubt: None,
            is_closed: false,
        };
        Self { contents: Mutex::new(contents), news: Condvar::new() }
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, Outgoing> {
        locked(&self.contents)
    }

    /// Changes the messages, and wakes the sending thread.
    pub(super) fn put(&self, change: impl FnOnce(&mut Outgoing)) {
        change(&mut self.lock());
        self.news.notify_one();
    }

    /// Waits until there is something to send, at most for this time.
    pub(super) fn wait(&self, longest: Duration) -> MutexGuard<'_, Outgoing> {
        let waited = self.news.wait_timeout_while(self.lock(), longest, |o| o.is_empty());
        waited.unwrap_or_else(PoisonError::into_inner).0
    }
}
