//! Result of `check` for one region and one robot.

use elbowroom_cell::{Cell, CellRegionId};
use elbowroom_diagnostic::Diagnostic;
use elbowroom_monitor::RegionKind;
use elbowroom_robot::RobotId;

/// Result of [`check`](super::check) for one region and one robot that it guards.
#[derive(Debug, Clone, PartialEq)]
pub struct EntryCheck {
    /// The region.
    pub region: CellRegionId,
    /// The robot.
    pub robot: RobotId,
    /// True if the active laws keep the robot out, under the assumptions in `reason`. False for a monitored region,
    /// which does not exclude entry.
    pub excluded: bool,
    /// Reason, in words.
    pub reason: String,
    /// What to write into the cell file instead; `None` if entry is excluded or no remedy is known.
    pub write_instead: Option<String>,
    /// Thickness (m) of the warning zone with which the robot stops in time without the stopping-distance law.
    ///
    /// `None` for a monitored region, and if no thickness is enough.
    pub needed_warning_m: Option<f64>,
    /// Warning before a run if the robot can overrun the border.
    pub overrun: Option<Diagnostic>,
}

impl EntryCheck {
    /// True if a robot can enter a region that forbids it.
    pub fn is_bad(&self, cell: &Cell) -> bool {
        !self.excluded && !matches!(cell.regions[self.region.0].region.kind, RegionKind::Monitored { .. })
    }
}
