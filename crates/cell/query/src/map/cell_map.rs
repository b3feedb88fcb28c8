//! The map of a robot, and a request for it.

use std::time::Duration;

use elbowroom_cspace::{GridAxis, OccupancyArray};
use elbowroom_formats::Diagnostic;

use super::blocked_cells::BlockedCells;
use super::model::MapModel;

/// A request for the map of a robot.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MapRequest {
    /// Name of the robot; optional if there is only one robot, or only one map.
    pub robot: Option<String>,
    /// Obstacle model of the objects.
    pub model: MapModel,
    /// Whether the robot's own solids decide at the border, which takes tenths of a second per object.
    ///
    /// Otherwise sphere covers of its links decide, in milliseconds, for maps of three joints, if one of these joints
    /// carries all links of the map. Other maps always use the solids.
    pub exact: bool,
    /// With the model of spheres, the time since the preparation of the robot until which spheres are added.
    ///
    /// One sphere around each object comes first, then more and smaller ones, at most as many as the model states.
    pub deadline: Option<Duration>,
}

/// Progress of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MapProgress<'a> {
    /// Finished fraction, 0..1.
    pub share: f64,
    /// The present work: the robot, or the name of an object.
    pub what: &'a str,
}

/// The map of a robot, and the cells that each object blocks.
#[derive(Debug, Clone)]
pub struct CellMap {
    /// Name of the robot.
    pub robot: String,
    /// The joint axes, divided into cells.
    pub axes: Vec<GridAxis>,
    /// Per axis: true for an angle.
    pub is_angle: Vec<bool>,
    /// One per object of the cell, in its order.
    pub obstacles: Vec<MapObstacle>,
    /// Number of cells that any object blocks.
    pub blocked: u64,
    /// Number of cells blocked by fixed objects.
    pub static_blocked: u64,
    /// The union of all obstacles, cell by cell; `None` if there are too many cells.
    pub dense: Option<OccupancyArray>,
    /// Warnings.
    pub warnings: Vec<Diagnostic>,
}

/// The cells blocked by one object.
#[derive(Debug, Clone)]
pub struct MapObstacle {
    /// Its name.
    pub name: String,
    /// Its obstacle model.
    pub model: MapModel,
    /// Number of spheres reached at the deadline, if there is one.
    pub spheres: Option<u32>,
    /// The blocked cells.
    pub blocks: BlockedCells,
    /// Time of the computation, without the preparation of the robot and of the object's shape.
    pub time: Duration,
}

impl CellMap {
    /// Number of cells.
    pub fn cells(&self) -> u64 {
        self.axes.iter().map(|a| a.count() as u64).fold(1, u64::saturating_mul)
    }

    /// Memory of the blocked cells, bytes.
    pub fn bytes(&self) -> usize {
        self.obstacles.iter().map(|o| o.blocks.bytes()).sum()
    }
}
