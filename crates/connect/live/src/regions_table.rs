//! Which regions a cell has now, and which of them are switched on.

use elbowroom_cell::{Cell, RegionEdit};
use elbowroom_interlock::Micros;
use elbowroom_monitor::Life;
use serde::{Deserialize, Serialize};

use crate::configuration_number::configuration_digits;

/// A node that has not heard which regions are switched on for this long guards against all of them; where regions may be added
/// and moved, it stops.
pub const TABLE_VALIDITY: Micros = Micros(1_000_000);

/// Which regions a cell has and which of them are switched on: kept by one process, and repeated to all others, so that a message
/// that is lost changes nothing for long.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RegionTable {
    /// The start of the process that keeps it, and how often it was changed: a higher pair replaces a lower one.
    pub revision: (u64, u64),
    /// Per region of the cell.
    pub active: Vec<bool>,
    /// The first 16 hexadecimal digits of the checksum of the cell file's configuration.
    pub configuration: String,
    /// The same of the configuration with the regions as they are now.
    pub present: String,
    /// The regions that are not as in the cell file.
    pub edits: Vec<RegionEdit>,
    /// While the nodes prepare for `present`: the configuration before, with which they may go on. Empty once `present` is due.
    pub former: String,
    /// Regions may be moved, added and removed while the cell runs.
    pub is_editable: bool,
}

/// A [`RegionTable`] as published.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct RegionTableMessage {
    /// The first 16 hexadecimal digits of the checksum of the cell file's configuration.
    pub configuration: String,
    /// The start of the process that keeps the table.
    pub boot: u64,
    /// How often it was changed.
    pub revision: u64,
    /// Per region, in the order of the cell file, its name and whether it is on.
    pub regions: Vec<(String, bool)>,
    /// Like `configuration`, with the present regions; empty if no region of the file has changed.
    #[serde(default)]
    pub present: String,
    /// The regions that are not as in the cell file.
    #[serde(default)]
    pub edits: Vec<RegionEdit>,
    /// Whoever runs neither with `present` nor with this one must stop; empty if only `present` counts.
    #[serde(default)]
    pub former: String,
    /// Regions may be moved, added and removed: whoever does not hear this any more must stop.
    #[serde(default)]
    pub editable: bool,
}

impl RegionTable {
    /// Until it is known what is on: permanent regions are on, temporary ones off. Whoever uses it guards against all of them then.
    pub fn initial(cell: &Cell) -> Self {
        Self {
            active: cell.regions.iter().map(|r| r.region.life == Life::Permanent).collect(),
            configuration: configuration_digits(cell),
            present: configuration_digits(cell),
            ..Self::default()
        }
    }

    /// With all regions on.
    #[must_use]
    pub fn all_on(mut self) -> Self {
        self.active.fill(true);
        self
    }

    /// Switches a region, by its index in the cell; false if that changes nothing. Only for temporary regions.
    pub fn switch(&mut self, region: usize, active: bool) -> bool {
        if self.active[region] == active {
            return false;
        }
        self.active[region] = active;
        self.revision.1 += 1;
        true
    }

    /// The message of this table. The cell is that of the table, with its edits.
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

    /// Whether a robot may go on with the configuration of this number.
    pub fn permits(&self, number: &str) -> bool {
        self.present == number || self.former == number
    }

    /// Takes over what is in a message, if it is of this cell file and not older than what is known. Returns whether it is. `cell`
    /// is that of which this table has the regions: it may be another one than that of the message.
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
            // A permanent region is never off, whatever a message says; one that the message does not have stays as it is until
            // this process has the same regions.
            *active = r.region.life == Life::Permanent || found.map_or(*active, |(_, on)| *on);
        }
        true
    }
}
