//! Builder of a node's configuration for other regions, outside the tick's thread.

use std::sync::Arc;
use std::time::Duration;

use elbowroom_cell::{Cell, configure};
use elbowroom_formats::Diagnostic;
use elbowroom_monitor::{ConfigError, Interlock, Monitor, RegionKind, same_regions};
use elbowroom_robot::RobotId;
use thiserror::Error;

use super::inbox::{Inbox, Wanted};
use super::next_configuration::{NextConfiguration, NodeVersion};
use crate::cell_versions::{CellVersions, NoVersion};
use crate::clock::Clock;
use crate::configuration_number::configuration_digits;

/// Longest wait for something to build, and base of the pause after a failure: a file may be missing for a while.
pub(super) const AGAIN_AFTER: Duration = Duration::from_secs(1);

/// Why a node cannot have the regions of a table.
#[derive(Debug, Error)]
pub enum RegionsError {
    /// The cell cannot have these regions.
    #[error(transparent)]
    Cell(#[from] NoVersion),
    /// The regions are not as another process built them.
    #[error("this process builds other regions from the same keys: its cell file, or a file that it names, differs")]
    OtherFiles,
    /// The monitors of the cell cannot be configured.
    #[error(transparent)]
    Setup(#[from] Diagnostic),
    /// The cell does not have the robot of the node.
    #[error("no such robot")]
    NoRobot,
    /// The monitor refuses the regions.
    #[error(transparent)]
    Monitor(#[from] ConfigError),
}

/// Builds a node's configuration for other regions.
///
/// [`Node`](super::Node) runs one on a separate thread; a program with its own loop calls [`Self::build`] on any thread
/// except that of the ticks.
pub struct RegionBuilder {
    inbox: Arc<Inbox>,
    versions: Arc<CellVersions>,
    robot: RobotId,
    interlock: Option<Interlock>,
    /// Versions held here, so that the tick never frees one.
    kept: Vec<Arc<NodeVersion>>,
}

impl RegionBuilder {
    pub(super) fn new(
        inbox: Arc<Inbox>,
        versions: Arc<CellVersions>,
        robot: RobotId,
        interlock: Option<Interlock>,
        version: Arc<NodeVersion>,
    ) -> Self {
        Self { inbox, versions, robot, interlock, kept: vec![version] }
    }

    /// Builds the monitor for the last table received, and stores it for the next tick.
    ///
    /// Returns false if there is nothing to build.
    ///
    /// # Errors
    /// [`RegionsError`] if the node cannot have these regions; it then stops once they are due.
    pub fn build(&mut self) -> Result<bool, RegionsError> {
        let (wanted, cell) = self.inbox.take_wanted();
        let Some(wanted) = wanted else { return Ok(false) };
        let next = self.next(&wanted, &cell)?;
        self.inbox.put_built(next);
        Ok(true)
    }

    /// Waits until other regions are wanted, and builds them. False at the end.
    pub(super) fn wait_and_build(&mut self, clock: Clock, longest: Duration) -> bool {
        let goes_on = self.inbox.wait_for_wanted(longest);
        if goes_on && self.build().is_err() {
            // The next table requests it again; the status says that the node has stopped, or continues with the
            // former regions.
            clock.sleep(AGAIN_AFTER / 4);
        }
        goes_on
    }

    fn next(&mut self, wanted: &Wanted, now: &Arc<Cell>) -> Result<Box<NextConfiguration>, RegionsError> {
        let cell = self.versions.cell(&wanted.edits)?;
        if configuration_digits(&cell) != wanted.number {
            return Err(RegionsError::OtherFiles);
        }
        let setup_of = |cell: &Cell| {
            let mut setups = configure::setups(cell)?;
            if self.robot.0 < setups.len() { Ok(setups.swap_remove(self.robot.0)) } else { Err(RegionsError::NoRobot) }
        };
        let (setup, former) = (setup_of(&cell)?, setup_of(now)?);
        let has_exchange = setup.configuration.regions().iter().any(|r| matches!(r.kind, RegionKind::Exchange { .. }));
        let interlock = self.interlock.clone().filter(|_| has_exchange);
        let monitor = Monitor::new(setup.configuration.clone(), interlock)?;
        let is_base = Arc::ptr_eq(&cell, self.versions.base());
        let number = if is_base { String::new() } else { wanted.number.clone() };
        let version = Arc::new(NodeVersion { number, configuration: setup.configuration.clone() });
        self.kept.retain(|version| Arc::strong_count(version) > 1);
        self.kept.push(version.clone());
        let before = |r: &elbowroom_cell::CellRegion| {
            let name = &r.region.name;
            let is_on = || wanted.regions.iter().any(|(named, on)| named == name && *on);
            now.regions.iter().position(|b| b.region.name == *name).ok_or_else(is_on)
        };
        Ok(Box::new(NextConfiguration {
            from: configuration_digits(now),
            number: wanted.number.clone(),
            same: same_regions(monitor.configuration(), &former.configuration),
            sources: Vec::with_capacity(setup.sources.len()),
            before: cell.regions.iter().map(before).collect(),
            active: vec![true; cell.regions.len()],
            active_of_inbox: vec![true; cell.regions.len()],
            cell_of_inbox: cell.clone(),
            recorder: None,
            cell,
            setup,
            monitor,
            version,
        }))
    }
}
