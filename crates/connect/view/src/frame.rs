//! Frame that is sent to the page: a status and its distances.

use elbowroom_status::{CellStatus, PlacedStatus, RobotStatus, SlotStatus};
use serde::Serialize;

/// State of the cell at one instant.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct ViewFrame {
    /// Number of the frame, which increases.
    pub number: u64,
    /// Time since the service started, s.
    pub t_s: f64,
    /// The nearest of all pairs, as `elbowroom query CELL --ask distance` at these joint values; `None` without pairs.
    pub nearest: Option<PairSeparation>,
    /// The robots in the order of the cell file.
    pub robots: Vec<FrameRobot>,
    /// Objects that have moved since the start.
    pub objects: Vec<PlacedStatus>,
    /// The exchange regions and their holders.
    pub slots: Vec<SlotStatus>,
    /// Error of the last command of a page; empty if it was carried out.
    pub message: String,
    /// Time taken to measure the distances, s.
    pub measured_in_s: f64,
}

/// A robot with its distances.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct FrameRobot {
    /// Status that its monitor reports.
    #[serde(flatten)]
    pub status: RobotStatus,
    /// The nearest pair with another robot or an object, as `query --no-self`.
    pub nearest: Option<PairSeparation>,
    /// The nearest pair of its own links.
    pub nearest_self: Option<PairSeparation>,
    /// Distances from its regions, on or off, in the order of the cell file.
    pub distances: Vec<RegionDistance>,
}

/// A pair of links or objects with its distance.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairSeparation {
    /// Name of the link, `robot/link`, or of the object.
    pub a: String,
    /// Name of the link, `robot/link`, or of the object.
    pub b: String,
    /// Distance of their surfaces, 0 on contact, m.
    pub distance_m: f64,
    /// The nearest points in the world, on `a` and on `b`, m.
    pub points_m: [[f64; 3]; 2],
}

/// A region and the guarded volume of a robot that is nearest to it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RegionDistance {
    /// Name of the region.
    pub region: String,
    /// Name of the volume.
    pub part: String,
    /// Distance, 0 inside, m.
    pub distance_m: f64,
    /// The nearest points in the world, on the volume and on the region, m.
    pub points_m: [[f64; 3]; 2],
}

impl ViewFrame {
    /// Makes a frame without the nearest pair of all.
    pub(crate) fn of(status: CellStatus, robots: Vec<FrameRobot>) -> Self {
        let CellStatus { t_s, objects, slots, .. } = status;
        Self { t_s, robots, objects, slots, ..Self::default() }
    }
}
