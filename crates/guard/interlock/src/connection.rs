//! Connection of a monitor to the arbiter of its exchange regions.

use std::sync::Arc;

use crate::{RobotSlot, SlotGrants, ZoneArbiter};

/// The source of the grants for a monitor's exchange regions.
#[derive(Debug, Clone)]
pub enum Interlock {
    /// The arbiter that all monitors of the process share, and the slot of this robot in it.
    Shared(Arc<ZoneArbiter>, RobotSlot),
    /// Grants that the caller writes before each tick, for robots whose monitors are in other processes.
    Granted(Arc<SlotGrants>),
}

impl From<(Arc<ZoneArbiter>, RobotSlot)> for Interlock {
    fn from((arbiter, robot): (Arc<ZoneArbiter>, RobotSlot)) -> Self {
        Self::Shared(arbiter, robot)
    }
}
