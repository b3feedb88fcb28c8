//! What the page is sent: a status, and the distances that belong to it.

use elbowroom_status::{CellStatus, PlacedStatus, RobotStatus, SlotStatus};
use serde::Serialize;

/// An instant of the cell.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Frame {
    /// Rises with each frame.
    pub number: u64,
    /// Time since the service started, s.
    pub t_s: f64,
    /// The nearest pair of all, as `elbowroom query CELL --ask distance` at these joint values; `None` without pairs.
    pub nearest: Option<PairSeparation>,
    /// In the order of the cell file.
    pub robots: Vec<FrameRobot>,
    /// Objects that have moved since the start.
    pub objects: Vec<PlacedStatus>,
    /// The exchange regions and who holds them.
    pub slots: Vec<SlotStatus>,
    /// What the last command of a page led to; empty if it was carried out.
    pub message: String,
    /// Time that the distances took, s.
    pub measured_in_s: f64,
}

/// A robot with its distances.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FrameRobot {
    /// What its monitor says.
    #[serde(flatten)]
    pub status: RobotStatus,
    /// The nearest pair with another robot or an object, as `query --no-self`.
    pub nearest: Option<PairSeparation>,
    /// The nearest pair of its own links.
    pub nearest_self: Option<PairSeparation>,
    /// Its regions, switched on or not, in the order of the cell file.
    pub distances: Vec<RegionDistance>,
}

/// A pair of links or objects with its distance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairSeparation {
    /// `robot/link`, or the object.
    pub a: String,
    /// `robot/link`, or the object.
    pub b: String,
    /// Distance of their surfaces, 0 on contact, m.
    pub distance_m: f64,
    /// The nearest points in the world, on `a` and on `b`, m.
    pub points_m: [[f64; 3]; 2],
}

/// A region and the guarded volume of a robot that is nearest to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegionDistance {
    /// The region.
    pub region: String,
    /// The volume.
    pub part: String,
    /// Distance, 0 inside, m.
    pub distance_m: f64,
    /// The nearest points in the world, on the volume and on the region, m.
    pub points_m: [[f64; 3]; 2],
}

impl Frame {
    /// A frame without distances.
    pub(crate) fn of(status: CellStatus, robots: Vec<FrameRobot>) -> Self {
        let CellStatus { t_s, objects, slots, .. } = status;
        Self { t_s, robots, objects, slots, ..Self::default() }
    }
}
