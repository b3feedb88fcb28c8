//! The way of a running cell's status into the view.

use std::sync::Arc;

use elbowroom_status::CellStatus;

use crate::inbox::Inbox;

/// Takes the statuses of a running cell. Clones are the same feed.
#[derive(Debug, Clone, Default)]
pub struct StatusFeed {
    pub(crate) inbox: Arc<Inbox>,
}

impl StatusFeed {
    /// A feed for one [`Server`](crate::Server).
    pub fn new() -> Self {
        Self::default()
    }

    /// Shows this status, at most 60 times per second: of several that come faster the last counts. Their events are all kept.
    ///
    /// Waits for no browser: it moves the status and returns. It frees the status before, so call it from a thread that publishes,
    /// not from a monitor's tick.
    pub fn publish(&self, status: CellStatus) {
        self.inbox.publish(status);
    }
}
