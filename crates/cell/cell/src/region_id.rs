//! Number of a region of a cell.

/// Index of a region in [`Cell::regions`](crate::Cell::regions).
///
/// A monitor's [`RegionId`](elbowroom_monitor::RegionId) is a different index;
/// [`MonitorSetup::regions`](crate::configure::MonitorSetup::regions) maps it to this one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CellRegionId(pub usize);
