//! Keeper of the table of a cell's regions: which exist and which are on, published to all nodes.

use std::collections::BTreeSet;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use elbowroom_cell::{Cell, CellRegion, CellRegionId, RegionEdit};
use elbowroom_interlock::Micros;
use elbowroom_monitor::Life;
use serde::{Deserialize, Serialize};

use crate::cell_versions::CellVersions;
use crate::clock::Clock;
use crate::configuration_number::configuration_digits;
use crate::event_handler::EventHandler;
use crate::keys::Keys;
use crate::locked::locked;
use crate::network::{Network, NetworkError, Publisher, Subscription, Urgency};
use crate::region_journal::{JournalError, RegionJournal};
use crate::regions_table::{RegionTable, RegionTableMessage};
use crate::worker::Worker;

/// Capacity of the request queue; further requests are dropped.
const WAITING: usize = 1024;
/// Interval at which the table is repeated; a change is published at once.
const PERIOD: Duration = Duration::from_millis(100);
const PERIOD_US: Micros = Micros(100_000);

/// A request of a program to switch a temporary region.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SwitchRequest {
    /// Robot whose program makes the request.
    pub robot: String,
    /// The region.
    pub region: String,
    /// On or off.
    pub active: bool,
}

/// Whether requests under [`Keys::switch`] are obeyed: their sender is unknown.
#[derive(Clone)]
pub enum ProgramSwitches {
    /// Requests switch temporary regions.
    Obeyed,
    /// Requests switch nothing; the first one for each region is reported.
    Ignored(Option<EventHandler>),
}

/// A table, the cell with its regions, and the journal that the table is written to.
struct Kept {
    table: RegionTable,
    cell: Arc<Cell>,
    journal: Option<RegionJournal>,
    on_event: Option<EventHandler>,
}

impl Kept {
    /// Restores the table from the journal, if the journal is of this cell file and no other process has it; otherwise all
    /// regions are on.
    fn begin(
        versions: &CellVersions,
        boot: u64,
        journal: Result<RegionJournal, JournalError>,
        on_event: Option<EventHandler>,
    ) -> (Self, String) {
        let base = versions.base();
        let fresh = RegionTable { revision: (boot, 0), ..RegionTable::initial(base).all_on() };
        let (continued, journal) = match journal {
            Ok(journal) => (continued(versions, &fresh, &journal), Some(journal)),
            Err(why) => (Err(why), None),
        };
        let (table, cell, how) = match continued {
            Ok((table, cell)) => (table, cell, "the regions are as they were when this process ended".to_owned()),
            Err(why) => (fresh, base.clone(), format!("all temporary regions are on until they are switched: {why}")),
        };
        let kept = Self { table, cell, journal, on_event };
        if kept.switches_regions() || !kept.table.edits.is_empty() {
            kept.record();
        }
        (kept, how)
    }

    fn switches_regions(&self) -> bool {
        self.cell.regions.iter().any(|r| r.region.life == Life::Temporary)
    }

    /// Writes the table, before it is published.
    fn record(&self) {
        let Some(journal) = &self.journal else { return };
        if let (Err(e), Some(on_event)) = (journal.write(&self.table.message(&self.cell)), &self.on_event) {
            on_event(&format!(
                "{}: cannot be written: {e}. If this process starts again all temporary regions of the file are on, and those that were added are gone",
                journal.path().display()
            ));
        }
    }

    /// Switches a temporary region; returns false if it already has that state.
    fn switch(&mut self, region: CellRegionId, active: bool) -> bool {
        let has_changed = self.table.switch(region, active);
        if has_changed {
            self.record();
        }
        has_changed
    }
}

/// Continues the table written by an earlier start; returns it with the cell that has its regions.
fn continued(
    versions: &CellVersions,
    fresh: &RegionTable,
    journal: &RegionJournal,
) -> Result<(RegionTable, Arc<Cell>), JournalError> {
    let written = journal.read()?;
    let file = || journal.path().to_owned();
    if written.configuration != fresh.configuration {
        return Err(JournalError::OtherCell(file()));
    }
    let cell = versions.cell(&written.edits).map_err(|source| JournalError::Regions { file: file(), source })?;
    let mut table = fresh.clone();
    table.active = vec![true; cell.regions.len()];
    table.take(
        &RegionTableMessage {
            revision: 0,
            boot: fresh.revision.0.max(written.boot.saturating_add(1)),
            ..written.clone()
        },
        &cell,
    );
    (table.edits, table.present) = (written.edits.clone(), configuration_digits(&cell));
    (table.former, table.is_editable) = (String::new(), false);
    Ok((table, cell))
}

/// Regions of a cell at one instant.
#[derive(Debug, Clone)]
pub(crate) struct PresentRegions {
    pub(crate) cell: Arc<Cell>,
    /// Differences from the cell file.
    pub(crate) edits: Vec<RegionEdit>,
}

/// Keeps which regions a cell has and which are on; exactly one process of a cell runs it. It ends when it is dropped.
pub struct RegionKeeper {
    kept: Arc<Mutex<Kept>>,
    at_start: String,
    subscription: Option<Subscription>,
    inbox: Option<SyncSender<Incoming>>,
    worker: Option<Worker>,
    // Kept because a network may end with its last owner.
    _network: Arc<dyn Network>,
}

impl RegionKeeper {
    /// Starts with the regions that the journal has from an earlier start; without a usable journal all regions are on.
    ///
    /// `boot` is higher than at earlier starts.
    ///
    /// # Errors
    /// [`NetworkError`] if the keys cannot be used.
    pub(crate) fn start(
        versions: &CellVersions,
        (network, clock): (&Arc<dyn Network>, Clock),
        boot: u64,
        programs: ProgramSwitches,
        journal: Result<RegionJournal, JournalError>,
        on_event: Option<EventHandler>,
    ) -> Result<Self, NetworkError> {
        let cell = versions.base();
        let (kept, at_start) = Kept::begin(versions, boot, journal, on_event);
        if let (true, Some(on_event)) = (kept.switches_regions(), &kept.on_event) {
            on_event(&at_start);
        }
        let kept = Arc::new(Mutex::new(kept));
        let (inbox, waiting) = mpsc::sync_channel(WAITING);
        let keys = Keys::new(&cell.name);
        let requests = inbox.clone();
        let handler = Box::new(move |bytes: &[u8]| {
            let Ok(request) = serde_json::from_slice::<SwitchRequest>(bytes) else { return };
            // A full queue drops the message.
            let _ = requests.try_send(Incoming::Request(request));
        });
        let subscription = network.subscribe(&keys.switch(), handler)?;
        let publisher = network.publisher(&keys.regions(), Urgency::RealTime)?;
        let mut running =
            Running { kept: kept.clone(), publisher, programs, ignored: Ignored::default(), clock, published: None };
        let step = move |longest| running.step(&waiting, longest);
        let worker = Some(Worker::start("regions", clock, PERIOD, Box::new(step)));
        Ok(Self {
            kept,
            at_start,
            subscription: Some(subscription),
            inbox: Some(inbox),
            worker,
            _network: network.clone(),
        })
    }

    /// Origin of the regions at the start, as text.
    pub(crate) fn at_start(&self) -> &str {
        &self.at_start
    }

    /// Whether each region of the present cell is on.
    pub fn active(&self) -> Vec<bool> {
        locked(&self.kept).table.active.clone()
    }

    /// The present regions.
    pub(crate) fn present(&self) -> PresentRegions {
        let kept = locked(&self.kept);
        PresentRegions { cell: kept.cell.clone(), edits: kept.table.edits.clone() }
    }

    /// Switches a temporary region of the present cell, and notifies the nodes at once.
    ///
    /// Permanent regions stay on.
    pub fn switch(&self, region: CellRegionId, active: bool) {
        if locked(&self.kept).switch(region, active) {
            self.publish();
        }
    }

    /// Allows regions to be moved, added and removed: from now on nodes that do not receive this keeper's table stop.
    pub(crate) fn allow_edits(&self) {
        locked(&self.kept).table.is_editable = true;
        self.publish();
    }

    /// Replaces the regions.
    ///
    /// Existing regions keep their on or off state; new temporary ones get `new_are_on`, permanent ones are on. Until
    /// it is called with `is_due`, nodes may continue with the previous regions. Returns the revision of the table.
    pub(crate) fn set(&self, regions: &PresentRegions, new_are_on: bool, is_due: bool) -> (u64, u64) {
        let mut kept = locked(&self.kept);
        let PresentRegions { cell, edits } = regions;
        let was_on = |name: &str| {
            let before = kept.cell.regions.iter().zip(&kept.table.active);
            before.filter(|(r, _)| r.region.name == name).map(|(_, on)| *on).next()
        };
        let on = |r: &elbowroom_cell::CellRegion| {
            r.region.life == Life::Permanent || was_on(&r.region.name).unwrap_or(new_are_on)
        };
        let active = cell.regions.iter().map(on).collect();
        let table = &mut kept.table;
        (table.active, table.edits) = (active, edits.clone());
        let former = std::mem::replace(&mut table.present, configuration_digits(cell));
        table.former = if is_due { String::new() } else { former };
        table.revision.1 += 1;
        let revision = table.revision;
        kept.cell = cell.clone();
        kept.record();
        drop(kept);
        self.publish();
        revision
    }

    fn publish(&self) {
        if let Some(inbox) = &self.inbox {
            // If the queue is full, its messages wake the thread.
            let _ = inbox.try_send(Incoming::Change);
        }
    }
}

/// Input of the keeper's thread.
enum Incoming {
    /// A program requests a switch.
    Request(SwitchRequest),
    /// The table has changed.
    Change,
}

/// The keeper's thread: repeats the table and obeys the requests of programs. It also writes the journal, because
/// threads of the network must not wait for the disk.
struct Running {
    kept: Arc<Mutex<Kept>>,
    publisher: Box<dyn Publisher>,
    programs: ProgramSwitches,
    ignored: Ignored,
    clock: Clock,
    /// Time of the last publication.
    published: Option<Micros>,
}

impl Running {
    /// Waits for input, and handles it; publishes the table after each input, and from time to time.
    fn step(&mut self, waiting: &Receiver<Incoming>, longest: Duration) -> bool {
        match waiting.recv_timeout(if self.published.is_none() { Duration::ZERO } else { longest }) {
            Ok(Incoming::Request(request)) => self.obey(&request),
            Ok(Incoming::Change) => {}
            Err(RecvTimeoutError::Timeout) => {
                if self.published.is_some_and(|at| self.clock.micros() - at < PERIOD_US) {
                    return true;
                }
            }
            Err(RecvTimeoutError::Disconnected) => return false,
        }
        self.published = Some(self.clock.micros());
        self.publish();
        true
    }

    fn publish(&mut self) {
        let message = {
            let kept = locked(&self.kept);
            kept.table.message(&kept.cell)
        };
        if let Ok(json) = serde_json::to_vec(&message) {
            self.publisher.publish(&json);
        }
    }

    /// Switches the region, or reports that the request is ignored.
    fn obey(&self, request: &SwitchRequest) {
        let mut kept = locked(&self.kept);
        let Some(region) = find(&request.region, &kept.cell) else { return };
        match &self.programs {
            ProgramSwitches::Ignored(on_event) => self.ignored.report(request, on_event.as_ref()),
            ProgramSwitches::Obeyed => {
                kept.switch(region, request.active);
            }
        }
    }
}

/// Finds the temporary region of this name. Permanent regions are never switched.
fn find(name: &str, cell: &Cell) -> Option<CellRegionId> {
    let is_found = |r: &CellRegion| r.region.name == name && r.region.life == Life::Temporary;
    cell.regions.iter().position(is_found).map(CellRegionId)
}

/// Names of regions with ignored requests, to report each region of the cell once: programs repeat their requests, and
/// names that are not in the cell would be unbounded.
#[derive(Default)]
struct Ignored(Mutex<BTreeSet<String>>);

impl Ignored {
    fn report(&self, request: &SwitchRequest, on_event: Option<&EventHandler>) {
        let is_new = locked(&self.0).insert(request.region.clone());
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
        self.inbox = None;
        self.worker = None;
    }
}
