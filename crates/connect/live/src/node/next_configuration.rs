//! Configuration of a node after a change of its regions: made outside the tick's thread, exchanged between two ticks.

use std::sync::Arc;

use elbowroom_cell::Cell;
use elbowroom_cell::configure::MonitorSetup;
use elbowroom_monitor::{Configuration, Monitor, RegionId, SourceState};
use elbowroom_recording::TickRecorder;

/// The configuration of a tick, for display of its results.
#[derive(Debug)]
pub(super) struct NodeVersion {
    /// The first 16 hexadecimal digits of the cell's checksum; empty for the cell file's regions.
    pub(super) number: String,
    pub(super) configuration: Configuration,
}

/// Other regions for a node. After the exchange it holds the node's former parts, so that the tick frees no memory.
pub(super) struct NextConfiguration {
    /// Number of the configuration that it can replace; `number` is its own.
    pub(super) from: String,
    pub(super) number: String,
    pub(super) cell: Arc<Cell>,
    /// The same cell, for the inbox.
    pub(super) cell_of_inbox: Arc<Cell>,
    pub(super) setup: MonitorSetup,
    pub(super) monitor: Monitor,
    /// Per region of the monitor, the same region of the former monitor; `None` if it has changed.
    pub(super) same: Vec<Option<RegionId>>,
    pub(super) sources: Vec<SourceState>,
    /// Per region of the cell, the former region of the same name; without one, whether the region is on.
    pub(super) before: Vec<Result<usize, bool>>,
    /// Memory for the on and off states of regions, for the tick and for the inbox.
    pub(super) active: Vec<bool>,
    pub(super) active_of_inbox: Vec<bool>,
    pub(super) version: Arc<NodeVersion>,
    /// The recorder of the former configuration.
    pub(super) recorder: Option<TickRecorder>,
}
