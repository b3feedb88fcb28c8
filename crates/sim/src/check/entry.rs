//! What is known of one region and one robot.

use elbowroom_cell::Cell;
use elbowroom_formats::Warning;
use elbowroom_monitor::RegionKind;

/// What is known of one region and one robot that it concerns.
#[derive(Debug, Clone, PartialEq)]
pub struct EntryCheck {
    /// Index of the region in the cell.
    pub region: usize,
    /// Index of the robot in the cell.
    pub robot: usize,
    /// True where the laws that are on keep the robot out, under the assumptions in `reason`. False for a monitored region,
    /// which is not meant to keep anybody out.
    pub excluded: bool,
    /// Why, in words.
    pub reason: String,
    /// What to write into the cell file instead, where entry is not excluded and that can be said.
    pub write_instead: Option<String>,
    /// Thickness (m) of the warning zone from which the robot stops in time without the stopping-distance law; `None` for a
    /// monitored region, and where no thickness is enough.
    pub needed_warning_m: Option<f64>,
    /// Where the robot can overrun the border: what to tell the user before a run.
    pub overrun: Option<Warning>,
}

impl EntryCheck {
    /// True where a robot can enter a region that is meant to keep it out.
    pub fn is_bad(&self, cell: &Cell) -> bool {
        !self.excluded && !matches!(cell.regions[self.region].region.kind, RegionKind::Monitored { .. })
    }
}
