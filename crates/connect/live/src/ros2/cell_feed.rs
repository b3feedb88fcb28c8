//! Newest status of the cell, for a thread that publishes it.

use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use elbowroom_status::CellStatus;

use crate::locked::locked;

/// Interval at which a thread without news checks whether it has to end.
const POLL: Duration = Duration::from_millis(100);

/// The newest status; a status that is not published yet is replaced by the next one. Clones share the feed.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellFeed(Arc<(Mutex<Latest>, Condvar)>);

#[derive(Debug, Default)]
struct Latest {
    status: Option<CellStatus>,
    is_closed: bool,
}

impl CellFeed {
    /// Stores a status, without waiting.
    pub(crate) fn publish(&self, status: CellStatus) {
        self.change(|latest| latest.status = Some(status));
    }

    /// Ends the waiting thread.
    pub(super) fn close(&self) {
        self.change(|latest| latest.is_closed = true);
    }

    fn change(&self, change: impl FnOnce(&mut Latest)) {
        change(&mut locked(&self.0.0));
        self.0.1.notify_one();
    }

    /// Waits for a status for a short time; false at the end.
    pub(super) fn wait(&self, status: &mut Option<CellStatus>) -> bool {
        let latest = locked(&self.0.0);
        let is_idle = |latest: &mut Latest| latest.status.is_none() && !latest.is_closed;
        let waited = self.0.1.wait_timeout_while(latest, POLL, is_idle);
        let mut latest = waited.unwrap_or_else(PoisonError::into_inner).0;
        *status = latest.status.take();
        !latest.is_closed
    }
}
