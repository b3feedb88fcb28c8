//! Table of a cell's present regions, and whether they are on.

use elbowroom_cell::{Cell, CellRegionId, RegionEdit};
use elbowroom_interlock::Micros;
use elbowroom_monitor::Life;
use serde::{Deserialize, Serialize};

use crate::configuration_number::configuration_digits;

/// Time for which the last received table is valid.
///
/// Without a valid table a node guards against all regions; if regions may be edited, it stops.
pub const TABLE_VALIDITY: Micros = Micros(1_000_000);

/// The regions of a cell and whether they are on.
///
/// One process keeps the table and repeats it to all others, so a lost message has no lasting effect.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RegionTable {
    /// Number of the start of the keeping process, and count of changes since: a higher pair replaces a lower one.
    pub revision: (u64, u64),
    /// Whether each region of the cell is on.
    pub active: Vec<bool>,
    /// The first 16 hexadecimal digits of the checksum of the cell file's configuration.
    pub configuration: String,
    /// The first 16 hexadecimal digits of the checksum of the configuration with the present regions.
    pub present: String,
    /// Regions that differ from the cell file.
    pub edits: Vec<RegionEdit>,
    /// The configuration before `present`, which nodes may still use while they prepare; empty once `present` is due.
    pub former: String,
    /// Whether regions may be moved, added and removed while the cell runs.
    pub is_editable: bool,
}

/// A [`RegionTable`] as published.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RegionTableMessage {
    /// The first 16 hexadecimal digits of the checksum of the cell file's configuration.
    pub configuration: String,
    /// Number of the start of the process that keeps the table.
    pub boot: u64,
    /// Count of changes since that start.
    pub revision: u64,
    /// Name of each region and whether it is on, in the order of the cell file.
    pub regions: Vec<(String, bool)>,
    /// Like `configuration`, with the present regions; empty if no region of the file has changed.
    #[serde(default)]
    pub present: String,
    /// Regions that differ from the cell file.
    #[serde(default)]
    pub edits: Vec<RegionEdit>,
    /// A node must stop if its configuration is neither `present` nor this one; empty if only `present` is valid.
    #[serde(default)]
    pub former: String,
    /// Whether regions may be moved, added and removed: a node that stops receiving the table must then stop its robot.
    #[serde(default)]
    pub editable: bool,
}

impl RegionTable {
    /// Creates the table for the time before the state is known: permanent regions on, temporary ones off.
    ///
    /// Its user guards against all regions during that time.
    pub fn initial(cell: &Cell) -> Self {
        Self {
            active: cell.regions.iter().map(|r| r.region.life == Life::Permanent).collect(),
            configuration: configuration_digits(cell),
            present: configuration_digits(cell),
            ..Self::default()
        }
    }

    /// Switches all regions on.
    #[must_use]
    pub fn all_on(mut self) -> Self {
        self.active.fill(true);
        self
    }

    /// Switches a temporary region; returns false if that changes nothing.
    pub fn switch(&mut self, region: CellRegionId, active: bool) -> bool {
        if self.active[region.0] == active {
            return false;
        }
        self.active[region.0] = active;
        self.revision.1 += 1;
        true
    }

    /// Makes the message of this table. `cell` is the cell of the table, with its edits.
    pub fn message(&self, cell: &Cell) -> RegionTableMessage {
        let regions = cell.regions.iter().zip(&self.active).map(|(r, on)| (r.region.name.clone(), *on)).collect();
        RegionTableMessage {
            configuration: self.configuration.clone(),
            boot: self.revision.0,
            revision: self.revision.1,
            regions,
            present: self.present.clone(),
            edits: self.edits.clone(),
            former: self.former.clone(),
            editable: self.is_editable,
        }
    }

    /// Whether a robot may continue with the configuration of this number.
    pub fn permits(&self, number: &str) -> bool {
        self.present == number || self.former == number
    }

    /// Applies a message if it is of this cell file and not older than this table.
    ///
    /// Returns whether it was applied. `cell` is the cell with the regions of this table; the message may be of another
    /// one.
    pub fn take(&mut self, message: &RegionTableMessage, cell: &Cell) -> bool {
        let revision = (message.boot, message.revision);
        if message.configuration != self.configuration || self.configuration.len() != 16 || revision < self.revision {
            return false;
        }
        self.revision = revision;
        self.is_editable = message.editable;
        self.former.clone_from(&message.former);
        let present = if message.present.is_empty() { &message.configuration } else { &message.present };
        self.present.clone_from(present);
        for (i, (active, r)) in self.active.iter_mut().zip(&cell.regions).enumerate() {
            let name = &r.region.name;
            let at_its_place = message.regions.get(i).filter(|(named, _)| named == name);
            let found = at_its_place.or_else(|| message.regions.iter().find(|(named, _)| named == name));
            // A permanent region is never off, whatever the message says; a region that is not in the message keeps its
            // state until this process has the same regions.
            *active = r.region.life == Life::Permanent || found.map_or(*active, |(_, on)| *on);
        }
        true
    }
}
