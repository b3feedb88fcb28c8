//! Which regions of a cell are switched on.

use elbowroom_cell::Cell;
use elbowroom_interlock::Micros;
use elbowroom_monitor::Life;
use serde::{Deserialize, Serialize};

/// A node that has not heard which regions are switched on for this long guards against all of them.
pub const TABLE_VALIDITY: Micros = Micros(1_000_000);

/// Which regions of a cell are switched on: kept by one process, and repeated to all others, so that a message that is lost
/// changes nothing for long.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RegionTable {
    /// The start of the process that keeps it, and how often it was changed: a higher pair replaces a lower one.
    pub revision: (u64, u64),
    /// Per region of the cell.
    pub active: Vec<bool>,
}

/// A [`RegionTable`] as published.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RegionTableMessage {
    /// The first 16 hexadecimal digits of the configuration's checksum.
    pub configuration: String,
    /// The start of the process that keeps the table.
    pub boot: u64,
    /// How often it was changed.
    pub revision: u64,
    /// Per region, in the order of the cell file, its name and whether it is on.
    pub regions: Vec<(String, bool)>,
}

impl RegionTable {
    /// As a cell begins: permanent regions are on, temporary ones off.
    pub fn initial(cell: &Cell) -> Self {
        Self { revision: (0, 0), active: cell.regions.iter().map(|r| r.region.life == Life::Permanent).collect() }
    }

    /// All regions are on: where it is not known which ones are.
    pub fn all_on(cell: &Cell) -> Self {
        Self { revision: (0, 0), active: vec![true; cell.regions.len()] }
    }

    /// Switches a region, by its index in the cell; false where that changes nothing. Only for temporary regions.
    pub fn switch(&mut self, region: usize, active: bool) -> bool {
        if self.active[region] == active {
            return false;
        }
        self.active[region] = active;
        self.revision.1 += 1;
        true
    }

    /// The message of this table.
    pub fn message(&self, cell: &Cell) -> RegionTableMessage {
        let regions = cell.regions.iter().zip(&self.active).map(|(r, on)| (r.region.name.clone(), *on)).collect();
        let configuration = cell.checksum.chars().take(16).collect();
        RegionTableMessage { configuration, boot: self.revision.0, revision: self.revision.1, regions }
    }

    /// Takes over what is in a message, if it is of this cell and not older than what is known. Returns whether it is.
    pub fn take(&mut self, message: &RegionTableMessage, cell: &Cell) -> bool {
        let is_of_cell = cell.checksum.starts_with(&message.configuration)
            && message.configuration.len() == 16
            && message.regions.len() == cell.regions.len();
        let revision = (message.boot, message.revision);
        if !is_of_cell || revision < self.revision {
            return false;
        }
        self.revision = revision;
        let active = cell.regions.iter().zip(&message.regions);
        self.active.clear();
        // A permanent region is never off, whatever a message says.
        self.active.extend(active.map(|(r, (_, on))| *on || r.region.life == Life::Permanent));
        true
    }
}
