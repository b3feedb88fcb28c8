//! Steps of a program that take no time.

use elbowroom_cell::CellRegionId;

use super::GripAction;

/// A switch of a region by a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RegionSwitch {
    /// The region.
    pub region: CellRegionId,
    /// On or off.
    pub active: bool,
}

/// Steps without duration that were executed and not taken yet.
#[derive(Debug, Default)]
pub(super) struct InstantSteps {
    pub switches: Vec<RegionSwitch>,
    pub grips: Vec<GripAction>,
    pub tools: Vec<usize>,
}
