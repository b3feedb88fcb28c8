//! The joint-space map of a robot of a cell (`elbowroom map`).
//!
//! Every object is an obstacle, moving ones at their initial poses. Self-collisions, other robots, and links that the
//! map's joints do not move are omitted.

use elbowroom_cell::Cell;
use elbowroom_formats::Diagnostic;

pub use self::blocked_cells::BlockedCells;
pub use self::cell_map::{CellMap, MapObstacle, MapProgress, MapRequest};
pub(crate) use self::link_maps::LinkMaps;
pub(crate) use self::map_axes::select_map;
pub use self::map_query::MapQuery;
pub use self::model::{MapModel, UnknownMapModel};
pub(crate) use self::solids_map::SolidsMap;

pub(crate) mod blocked_cells;
mod cell_map;
mod link_maps;
mod map_axes;
mod map_query;
pub(crate) mod mapped_joints;
mod model;
mod solids_map;

/// Computes the map of a robot. For more than one map of a robot, [`MapQuery`] is faster.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_query::map::{MapRequest, map};
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.arm]
/// dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
/// links = [[], { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
/// [object.ball]
/// shape = "sphere"
/// at = [600, 0, 0]
/// radius = 100
/// [map.arm]
/// step = 2
/// "#)?;
/// let map = map(&cell, &MapRequest::default())?;
/// assert_eq!(map.axes.iter().map(|a| a.count()).collect::<Vec<_>>(), [170, 170]);
/// assert!(map.obstacles[0].blocks.is_blocked(&[0.0, 0.0]) && map.blocked < 170 * 170 / 2);
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
///
/// # Errors
/// An unknown or ambiguous robot, a joint without limits, too many cells for the memory; a deadline with another model than
/// spheres, or for a map that is not on sphere covers.
pub fn map(cell: &Cell, request: &MapRequest) -> Result<CellMap, Diagnostic> {
    map_with(cell, request, &|_| ())
}

/// Like [`map`]; `progress` is called from any thread.
///
/// # Errors
/// As for [`map`].
pub fn map_with(
    cell: &Cell,
    request: &MapRequest,
    progress: &(dyn Fn(MapProgress<'_>) + Sync),
) -> Result<CellMap, Diagnostic> {
    MapQuery::new(cell, request, progress)?.map(request.model, request.deadline, progress)
}
