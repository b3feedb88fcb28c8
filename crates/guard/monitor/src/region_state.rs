//! State of one region of a monitor.

use crate::zone_state::ZoneState;
use crate::{Life, Region, RegionKind};

/// The state of one region.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RegionState {
    /// True if the region is switched on.
    pub(crate) active: bool,
    /// Reported position of the robot; always outside if the region is inactive.
    pub(crate) zone: ZoneState,
    /// Position of the robot, whether or not the region is active.
    pub(crate) presence: ZoneState,
    is_exchange: bool,
    /// False if the region follows a source whose pose is not known.
    pub(crate) is_placed: bool,
}

impl RegionState {
    /// The initial state: permanent regions are on, temporary regions are off.
    pub(crate) fn new(region: &Region) -> Self {
        Self {
            active: region.life == Life::Permanent,
            zone: ZoneState::default(),
            presence: ZoneState::default(),
            is_exchange: matches!(region.kind, RegionKind::Exchange { .. }),
            is_placed: true,
        }
    }

    /// True if the region is measured in this tick: active regions and all exchange regions are, at a known pose.
    pub(crate) fn is_measured(self) -> bool {
        self.is_placed && (self.active || self.is_exchange)
    }
}
