//! What a node goes on with after its regions have changed: made outside of the thread of the tick, exchanged between two ticks.

use std::sync::Arc;

use elbowroom_cell::Cell;
use elbowroom_cell::configure::MonitorSetup;
use elbowroom_monitor::{Configuration, Monitor, RegionId, SourceState};
use elbowroom_recording::TickRecorder;

/// The configuration of a tick, for whoever shows what it has found.
#[derive(Debug)]
pub(super) struct NodeVersion {
    /// The first 16 hexadecimal digits of the cell's checksum; empty for the cell file's regions.
    pub(super) number: String,
    pub(super) configuration: Configuration,
}

/// Other regions for a node. After the exchange it holds what the node had before, so that the tick frees no memory.
pub(super) struct NextConfiguration {
    /// Of the configuration that it can replace, and its own.
    pub(super) from: String,
    pub(super) number: String,
    pub(super) cell: Arc<Cell>,
    /// The same cell, for the inbox.
    pub(super) cell_of_inbox: Arc<Cell>,
    pub(super) setup: MonitorSetup,
    pub(super) monitor: Monitor,
    /// Per region of the monitor that of the monitor before, where nothing of it has changed.
    pub(super) same: Vec<Option<RegionId>>,
    pub(super) sources: Vec<SourceState>,
    /// Per region of the cell that of the same name before; without one, whether it is on.
    pub(super) before: Vec<Result<usize, bool>>,
    /// Memory for whether regions are on, for the tick and for the inbox.
    pub(super) active: Vec<bool>,
    pub(super) active_of_inbox: Vec<bool>,
    pub(super) version: Arc<NodeVersion>,
    /// The recorder of the former configuration.
    pub(super) recorder: Option<TickRecorder>,
}
