//! Feed of a running cell's status into the view.

use std::sync::Arc;

use elbowroom_status::CellStatus;

use crate::inbox::Inbox;

/// Receives the statuses of a running cell. Clones share the feed.
#[derive(Debug, Clone, Default)]
pub struct StatusFeed {
    pub(crate) inbox: Arc<Inbox>,
}

impl StatusFeed {
    /// Creates a feed for one [`Server`](crate::Server).
    pub fn new() -> Self {
        Self::default()
    }

    /// Shows this status, at most 60 times per second: of several statuses that come faster the last one is shown.
    ///
    /// All their events are kept.
    ///
    /// Never waits for a browser: it moves the status and returns. It frees the previous status, so call it from a
    /// thread that publishes, not from a monitor's tick.
    pub fn publish(&self, status: CellStatus) {
        self.inbox.publish(status);
    }
}
