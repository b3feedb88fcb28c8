//! The newest status of the cell, for a thread that publishes it.

use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use elbowroom_status::CellStatus;

/// How often a thread without news sees whether it has to end.
const POLL: Duration = Duration::from_millis(100);

/// The newest status: one that was not published yet is replaced by the next one. Clones are the same feed.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellFeed(Arc<(Mutex<Latest>, Condvar)>);

#[derive(Debug, Default)]
struct Latest {
    status: Option<CellStatus>,
    is_closed: bool,
}

impl CellFeed {
    /// Waits for nobody.
    pub(crate) fn publish(&self, status: CellStatus) {
        self.change(|latest| latest.status = Some(status));
    }

    /// Ends the thread that waits.
    pub(super) fn close(&self) {
        self.change(|latest| latest.is_closed = true);
    }

    fn change(&self, change: impl FnOnce(&mut Latest)) {
        change(&mut self.0.0.lock().unwrap_or_else(PoisonError::into_inner));
        self.0.1.notify_one();
    }

    /// Waits for a status, not long; false at the end.
    pub(super) fn wait(&self, status: &mut Option<CellStatus>) -> bool {
        let latest = self.0.0.lock().unwrap_or_else(PoisonError::into_inner);
        let is_idle = |latest: &mut Latest| latest.status.is_none() && !latest.is_closed;
        let waited = self.0.1.wait_timeout_while(latest, POLL, is_idle);
        let mut latest = waited.unwrap_or_else(PoisonError::into_inner).0;
        *status = latest.status.take();
        !latest.is_closed
    }
}
