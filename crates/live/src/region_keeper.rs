//! Keeps which regions of a cell are switched on, and tells all nodes.

use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use elbowroom_cell::Cell;
use elbowroom_monitor::Life;
use serde::{Deserialize, Serialize};

use crate::keys::Keys;
use crate::network::{Network, NetworkError, Subscription, Urgency};
use crate::regions_table::RegionTable;

/// How often the table is repeated; a change is published at once.
const PERIOD: Duration = Duration::from_millis(100);

/// A program switches a temporary region.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SwitchRequest {
    /// The robot whose program asks.
    pub robot: String,
    /// The region.
    pub region: String,
    /// On or off.
    pub active: bool,
}

/// Keeps which regions are switched on; one process of a cell has it. It ends when it is dropped.
pub struct RegionKeeper {
    subscription: Option<Subscription>,
    wake: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl RegionKeeper {
    /// Starts with the regions as the cell file has them. `boot` is higher than at former starts.
    ///
    /// # Errors
    /// [`NetworkError`] where the keys cannot be used.
    pub fn start(cell: &Arc<Cell>, network: &Arc<dyn Network>, boot: u64) -> Result<Self, NetworkError> {
        let table = Arc::new(Mutex::new(RegionTable { revision: (boot, 0), ..RegionTable::initial(cell) }));
        let (wake, woken) = mpsc::channel();
        let keys = Keys::new(&cell.name);
        let handler = {
            let (table, cell, wake) = (table.clone(), cell.clone(), wake.clone());
            Box::new(move |bytes: &[u8]| {
                if let Ok(request) = serde_json::from_slice::<SwitchRequest>(bytes)
                    && apply(&request, &cell, &mut table.lock().unwrap_or_else(PoisonError::into_inner))
                {
                    // The other side is gone only when the keeper ends.
                    let _ = wake.send(());
                }
            })
        };
        let subscription = network.subscribe(&keys.switch(), handler)?;
        let mut publisher = network.publisher(&keys.regions(), Urgency::RealTime)?;
        let cell = cell.clone();
        let publish = move || {
            loop {
                let message = table.lock().unwrap_or_else(PoisonError::into_inner).message(&cell);
                if let Ok(json) = serde_json::to_vec(&message) {
                    publisher.publish(&json);
                }
                match woken.recv_timeout(PERIOD) {
                    Ok(()) | Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => return,
                }
            }
        };
        let thread = std::thread::Builder::new().name("regions".into()).spawn(publish);
        Ok(Self { subscription: Some(subscription), wake: Some(wake), thread: thread.ok() })
    }
}

impl Drop for RegionKeeper {
    fn drop(&mut self) {
        // The subscription's handler holds the other sender.
        self.subscription = None;
        self.wake = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Applies a request; false where it changes nothing. A permanent region is never switched.
fn apply(request: &SwitchRequest, cell: &Cell, table: &mut RegionTable) -> bool {
    let region = cell.regions.iter().position(|r| r.region.name == request.region && r.region.life == Life::Temporary);
    match region {
        Some(region) if table.active[region] != request.active => {
            table.active[region] = request.active;
            table.revision.1 += 1;
            true
        }
        _ => false,
    }
}
