//! Keeps which regions of a cell are switched on, and tells all nodes.

use std::collections::BTreeSet;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use elbowroom_cell::Cell;
use elbowroom_monitor::Life;
use serde::{Deserialize, Serialize};

use crate::event_handler::EventHandler;
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

/// Whether what arrives under [`Keys::switch`] is obeyed: nobody knows who sends it.
#[derive(Clone)]
pub enum ProgramSwitches {
    /// Temporary regions are switched.
    Obeyed,
    /// Nothing is switched; the first such request of each region is reported.
    Ignored(Option<EventHandler>),
}

/// Keeps which regions are switched on; one process of a cell has it. It ends when it is dropped.
pub struct RegionKeeper {
    table: Arc<Mutex<RegionTable>>,
    subscription: Option<Subscription>,
    wake: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
    // A network may end with its last owner.
    _network: Arc<dyn Network>,
}

impl RegionKeeper {
    /// Starts with the regions as the cell file has them. `boot` is higher than at former starts.
    ///
    /// # Errors
    /// [`NetworkError`] where the keys cannot be used.
    pub fn start(
        cell: &Arc<Cell>,
        network: &Arc<dyn Network>,
        boot: u64,
        programs: ProgramSwitches,
    ) -> Result<Self, NetworkError> {
        let table = Arc::new(Mutex::new(RegionTable { revision: (boot, 0), ..RegionTable::initial(cell) }));
        let (wake, woken) = mpsc::channel();
        let keys = Keys::new(&cell.name);
        let handler = {
            let (table, cell, wake) = (table.clone(), cell.clone(), wake.clone());
            let ignored = Ignored::default();
            Box::new(move |bytes: &[u8]| {
                let Ok(request) = serde_json::from_slice::<SwitchRequest>(bytes) else { return };
                match &programs {
                    ProgramSwitches::Ignored(on_event) => ignored.report(&request, &cell, on_event.as_ref()),
                    ProgramSwitches::Obeyed => {
                        if find(&request.region, &cell).is_some_and(|r| lock(&table).switch(r, request.active)) {
                            // The other side is gone only when the keeper ends.
                            let _ = wake.send(());
                        }
                    }
                }
            })
        };
        let subscription = network.subscribe(&keys.switch(), handler)?;
        let mut publisher = network.publisher(&keys.regions(), Urgency::RealTime)?;
        let (published, cell) = (table.clone(), cell.clone());
        let publish = move || {
            loop {
                let message = lock(&published).message(&cell);
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
        Ok(Self {
            table,
            subscription: Some(subscription),
            wake: Some(wake),
            thread: thread.ok(),
            _network: network.clone(),
        })
    }

    /// Per region of the cell whether it is on.
    pub fn active(&self) -> Vec<bool> {
        lock(&self.table).active.clone()
    }

    /// Switches a temporary region, by its index in the cell; the nodes hear of it at once. Permanent regions stay on.
    pub fn switch(&self, region: usize, active: bool) {
        if lock(&self.table).switch(region, active)
            && let Some(wake) = &self.wake
        {
            let _ = wake.send(());
        }
    }
}

fn lock(table: &Mutex<RegionTable>) -> MutexGuard<'_, RegionTable> {
    table.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The temporary region of this name. A permanent one is never switched.
fn find(name: &str, cell: &Cell) -> Option<usize> {
    cell.regions.iter().position(|r| r.region.name == name && r.region.life == Life::Temporary)
}

/// Requests that were not obeyed. One report per region of the cell: programs repeat themselves, and names of regions that there
/// are not would be without end.
#[derive(Default)]
struct Ignored(Mutex<BTreeSet<usize>>);

impl Ignored {
    fn report(&self, request: &SwitchRequest, cell: &Cell, on_event: Option<&EventHandler>) {
        let Some(region) = find(&request.region, cell) else { return };
        let is_new = self.0.lock().unwrap_or_else(PoisonError::into_inner).insert(region);
        if let (true, Some(on_event)) = (is_new, on_event) {
            on_event(&format!(
                "{}: a request to switch it, without a token, was ignored (--program-switches obeys such requests)",
                request.region
            ));
        }
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
