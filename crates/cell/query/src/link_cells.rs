//! Which links block the cells of a map.

use elbowroom_cell::Cell;
use elbowroom_formats::Diagnostic;

use crate::map::{CellMap, MapRequest, map, select_map};

/// The cells that one link blocks.
#[derive(Debug)]
pub struct LinkCells {
    /// The link.
    pub link: String,
    /// The map of a robot that has only the solids of this link.
    pub map: CellMap,
}

impl LinkCells {
    /// Number of cells in which the link may touch an object, by its index in the map.
    ///
    /// # Panics
    /// There is no such object.
    pub fn blocked(&self, object: usize) -> u64 {
        self.map.obstacles[object].blocks.blocked()
    }
}

/// The cells that each link blocks, as if the others had no solids. A cell that several links block counts for each of them.
///
/// ```
/// use elbowroom_cell::Cell;
/// use elbowroom_query::blocked_by_link;
/// use elbowroom_query::map::{MapRequest, map};
/// let cell = Cell::parse("c.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.arm]
/// dh = [{ a = 400, min = -170, max = 170, speed = 90 }, { a = 300, min = -170, max = 170, speed = 90 }]
/// links = [{ capsule = { from = [-400, 0, 0], to = [0, 0, 0], radius = 40 } }, { capsule = { from = [-300, 0, 0], to = [0, 0, 0], radius = 40 } }]
/// [object.ball]
/// shape = "sphere"
/// at = [600, 0, 0]
/// radius = 100
/// [map.arm]
/// step = 2
/// "#)?;
/// let links = blocked_by_link(&cell, &MapRequest::default())?;
/// // The upper arm does not reach the ball.
/// assert_eq!(links.iter().map(|l| l.link.as_str()).collect::<Vec<_>>(), ["link_2"]);
/// assert_eq!(links[0].blocked(0), map(&cell, &MapRequest::default())?.blocked);
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
///
/// # Errors
/// As for [`map`].
pub fn blocked_by_link(cell: &Cell, request: &MapRequest) -> Result<Vec<LinkCells>, Diagnostic> {
    let (id, robot, _) = select_map(cell, request.robot.as_deref())?;
    let mut found = Vec::new();
    for link in robot.robot.links_with_colliders() {
        let mut alone = cell.clone();
        for (other, colliders) in alone.robots[id.0].robot.colliders.iter_mut().enumerate() {
            if other != link.0 {
                colliders.clear();
            }
        }
        let map = map(&alone, request)?;
        if map.blocked > 0 {
            found.push(LinkCells { link: robot.robot.chain.links()[link.0].clone(), map });
        }
    }
    Ok(found)
}
