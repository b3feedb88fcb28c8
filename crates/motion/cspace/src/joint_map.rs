//! The joint-space map of a planar arm.

use crate::{
    CellChanges, ConvexObstacle, Grid, Layer, LayerMap, MapReader, OccupancyBitmap, PlanarArm, PlanarMapBuilder,
    PlanarMapError,
};

/// Obstacles of a planar arm as blocked cells of joint space, one layer per obstacle.
///
/// One thread owns the map and changes it; any number of threads read it through a [`MapReader`].
///
/// ```
/// use elbowroom_cspace::{ConvexObstacle, Grid, GridAxis, JointMap, PlanarArm};
/// use elbowroom_spatial::Vec3;
/// let axis = |name: &str, min, max| GridAxis::from_degrees(name, min, max, 2.0);
/// let grid = Grid::new([axis("base", -170.0, 170.0)?, axis("shoulder", -90.0, 90.0)?, axis("elbow", -120.0, 150.0)?])?;
/// let mut map = JointMap::new(PlanarArm::KR125_SIZED, &grid)?;
/// let mut reader = map.reader();
/// let entered = map.set_obstacle("head", &ConvexObstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25)?);
/// assert!(entered.blocked() > 50_000 && entered.freed() == 0);
/// let moved = map.set_obstacle("head", &ConvexObstacle::sphere(Vec3::new(1.3, 0.41, 0.9), 0.25)?);
/// assert!(moved.blocked() < 4_000 && moved.freed() < 4_000);
/// assert_eq!(reader.latest().blocked(), 0); // not published yet
/// map.publish();
/// assert_eq!(reader.latest().blocked(), map.occupancy().blocked());
/// assert!(map.remove_obstacle("head").is_some());
/// assert_eq!(map.occupancy().blocked(), 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct JointMap {
    builder: PlanarMapBuilder,
    map: LayerMap,
}

impl JointMap {
    /// Creates a map without obstacles.
    ///
    /// # Errors
    /// The errors of [`PlanarMapBuilder::new`].
    pub fn new(arm: PlanarArm, grid: &Grid) -> Result<Self, PlanarMapError> {
        Ok(Self { builder: PlanarMapBuilder::new(arm, grid)?, map: LayerMap::new(grid) })
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        self.map.grid()
    }

    /// The occupancy of all layers together.
    pub fn occupancy(&self) -> &OccupancyBitmap {
        self.map.occupancy()
    }

    /// Names and layers of the obstacles, in the order in which they were added.
    pub fn layers(&self) -> impl Iterator<Item = (&str, &Layer)> {
        self.map.layers()
    }

    /// Whether a configuration (radians) is in a blocked cell or outside the limits.
    pub fn is_blocked(&self, q: [f64; 3]) -> bool {
        self.map.is_blocked(q)
    }

    /// Adds an obstacle, or replaces the obstacle of this name; returns the cells that changed.
    pub fn set_obstacle(&mut self, name: &str, obstacle: &ConvexObstacle) -> &CellChanges {
        let mut layer = std::mem::take(&mut self.map.spare);
        self.builder.build_layer(obstacle, &mut layer);
        self.map.set_layer(name, layer)
    }

    /// Like [`set_obstacle`](Self::set_obstacle), with a layer that was built elsewhere for the same grid.
    pub fn set_layer(&mut self, name: &str, layer: Layer) -> &CellChanges {
        self.map.set_layer(name, layer)
    }

    /// Removes an obstacle; `None` if the map has no obstacle of this name.
    pub fn remove_obstacle(&mut self, name: &str) -> Option<&CellChanges> {
        self.map.remove(name)
    }

    /// Replaces the static obstacles, such as fixtures, walls and floor; returns the cells that changed.
    pub fn set_fixed(&mut self, obstacles: &[ConvexObstacle]) -> CellChanges {
        let build = |obstacle: &ConvexObstacle| {
            let mut layer = Layer::new();
            self.builder.build_layer(obstacle, &mut layer);
            layer
        };
        let layers: Vec<Layer> = obstacles.iter().map(build).collect();
        self.map.set_fixed(&layers)
    }

    /// Publishes the current occupancy to readers.
    pub fn publish(&mut self) {
        self.map.publish();
    }

    /// Creates a reader of the published occupancy, for another thread.
    pub fn reader(&self) -> MapReader {
        self.map.reader()
    }
}
