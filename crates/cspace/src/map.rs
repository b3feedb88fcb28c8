//! The joint map of a planar arm: a filler and its layers.

use crate::{Changes, FillError, Filler, Grid, Layer, LayerMap, Obstacle, PlanarArm, Reader, Table};

/// Obstacles as blocked cells of joint space, each in a layer of its own.
///
/// One thread owns the map and changes it; any number of threads look at it through a [`Reader`].
///
/// ```
/// use elbowroom_cspace::{Axis, Grid, JointMap, Obstacle, PlanarArm};
/// use elbowroom_spatial::Vec3;
/// let axis = |name: &str, min, max| Axis::from_degrees(name, min, max, 2.0);
/// let grid = Grid::new([axis("base", -170.0, 170.0)?, axis("shoulder", -90.0, 90.0)?, axis("elbow", -120.0, 150.0)?])?;
/// let mut map = JointMap::new(PlanarArm::KR125_SIZED, &grid)?;
/// let mut reader = map.reader();
/// let entered = map.set("head", &Obstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25)?);
/// assert!(entered.blocked() > 50_000 && entered.freed() == 0);
/// let moved = map.set("head", &Obstacle::sphere(Vec3::new(1.3, 0.41, 0.9), 0.25)?);
/// assert!(moved.blocked() < 4_000 && moved.freed() < 4_000);
/// assert_eq!(reader.latest().blocked(), 0); // nothing was published
/// map.publish();
/// assert_eq!(reader.latest().blocked(), map.table().blocked());
/// assert!(map.remove("head").is_some());
/// assert_eq!(map.table().blocked(), 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct JointMap {
    filler: Filler,
    map: LayerMap,
}

impl JointMap {
    /// A map without obstacles.
    ///
    /// # Errors
    /// As [`Filler::new`].
    pub fn new(arm: PlanarArm, grid: &Grid) -> Result<Self, FillError> {
        Ok(Self { filler: Filler::new(arm, grid)?, map: LayerMap::new(grid) })
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        self.map.grid()
    }

    /// The table of all layers together.
    pub fn table(&self) -> &Table {
        self.map.table()
    }

    /// Names and layers of the obstacles, in the order in which they entered.
    pub fn layers(&self) -> impl Iterator<Item = (&str, &Layer)> {
        self.map.layers()
    }

    /// True where a configuration (radians) lies in a blocked cell, and where it lies outside the limits.
    pub fn is_blocked(&self, q: [f64; 3]) -> bool {
        self.map.is_blocked(q)
    }

    /// An obstacle enters, or moves if one of this name is there; the cells that changed.
    pub fn set(&mut self, name: &str, obstacle: &Obstacle) -> &Changes {
        let mut layer = std::mem::take(&mut self.map.spare);
        self.filler.fill(obstacle, &mut layer);
        self.map.set_layer(name, layer)
    }

    /// The same with a layer that was made elsewhere, for the same grid.
    pub fn set_layer(&mut self, name: &str, layer: Layer) -> &Changes {
        self.map.set_layer(name, layer)
    }

    /// An obstacle leaves; `None` where there was none of this name.
    pub fn remove(&mut self, name: &str) -> Option<&Changes> {
        self.map.remove(name)
    }

    /// Blocks cells for good: the cell's fixtures, walls and floor.
    pub fn set_fixed(&mut self, obstacles: &[Obstacle]) -> Changes {
        let fill = |obstacle: &Obstacle| {
            let mut layer = Layer::new();
            self.filler.fill(obstacle, &mut layer);
            layer
        };
        let layers: Vec<Layer> = obstacles.iter().map(fill).collect();
        self.map.set_fixed(&layers)
    }

    /// Makes the present table the one that readers see.
    pub fn publish(&mut self) {
        self.map.publish();
    }

    /// A view for another thread: what was published last.
    pub fn reader(&self) -> Reader {
        self.map.reader()
    }
}
