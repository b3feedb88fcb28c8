//! Consistent snapshots of the map for other threads.

use std::ops::Deref;
use std::sync::Arc;

use arc_swap::ArcSwap;

use crate::{CellChanges, OccupancyBitmap};

/// Published occupancy.
#[derive(Debug, Clone)]
pub struct MapSnapshot {
    pub(crate) occupancy: OccupancyBitmap,
    pub(crate) version: u64,
}

impl MapSnapshot {
    /// Number of publications before this snapshot; 0 is the empty map.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// The occupancy.
    pub fn occupancy(&self) -> &OccupancyBitmap {
        &self.occupancy
    }
}

impl Deref for MapSnapshot {
    type Target = OccupancyBitmap;

    fn deref(&self) -> &OccupancyBitmap {
        &self.occupancy
    }
}

/// The latest snapshot, shared with readers.
#[derive(Debug)]
pub(crate) struct PublishedMap(ArcSwap<MapSnapshot>);

impl PublishedMap {
    pub fn new(snapshot: MapSnapshot) -> Self {
        Self(ArcSwap::from_pointee(snapshot))
    }

    pub fn store(&self, snapshot: MapSnapshot) {
        self.0.store(Arc::new(snapshot));
    }
}

/// Reads, without locks, a map that another thread changes: a snapshot never changes while it is held.
///
/// ```
/// # use elbowroom_cspace::{ConvexObstacle, Grid, GridAxis, JointMap, PlanarArm};
/// # use elbowroom_spatial::Vec3;
/// # let axis = |name: &str| GridAxis::from_degrees(name, -90.0, 90.0, 5.0);
/// # let grid = Grid::new([axis("base")?, axis("shoulder")?, axis("elbow")?])?;
/// let mut map = JointMap::new(PlanarArm::KR125_SIZED, &grid)?;
/// let mut reader = map.reader();
/// map.set_obstacle("head", &ConvexObstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25)?);
/// map.publish();
/// let thread = std::thread::spawn(move || {
///     let changes = reader.refresh(); // all changes since this reader's previous snapshot
///     (changes.blocked(), reader.current().blocked())
/// });
/// let (added, total) = thread.join().unwrap();
/// assert!(added > 0 && added == total);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MapReader {
    published: Arc<PublishedMap>,
    current: Arc<MapSnapshot>,
}

impl MapReader {
    pub(crate) fn new(published: Arc<PublishedMap>) -> Self {
        let current = published.0.load_full();
        Self { published, current }
    }

    /// The snapshot that this reader loaded last.
    pub fn current(&self) -> &MapSnapshot {
        &self.current
    }

    /// Loads the newest snapshot.
    pub fn latest(&mut self) -> &MapSnapshot {
        self.current = self.published.0.load_full();
        &self.current
    }

    /// Loads the newest snapshot; returns exactly the cells that changed since the previous one, regardless of the
    /// number of publications in between.
    pub fn refresh(&mut self) -> CellChanges {
        let before = Arc::clone(&self.current);
        self.latest();
        CellChanges::between(&before.occupancy, &self.current.occupancy)
    }
}
