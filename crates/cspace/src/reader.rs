//! Consistent views of the map for other threads.

use std::ops::Deref;
use std::sync::Arc;

use arc_swap::ArcSwap;

use crate::{Changes, Table};

/// A table as it was published.
#[derive(Debug, Clone)]
pub struct Snapshot {
    pub(crate) table: Table,
    pub(crate) version: u64,
}

impl Snapshot {
    /// Counts publications; 0 is the empty map.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// The table.
    pub fn table(&self) -> &Table {
        &self.table
    }
}

impl Deref for Snapshot {
    type Target = Table;

    fn deref(&self) -> &Table {
        &self.table
    }
}

/// Where a snapshot is shown.
#[derive(Debug)]
pub(crate) struct Window(ArcSwap<Snapshot>);

impl Window {
    pub fn new(snapshot: Snapshot) -> Self {
        Self(ArcSwap::from_pointee(snapshot))
    }

    pub fn show(&self, snapshot: Snapshot) {
        self.0.store(Arc::new(snapshot));
    }
}

/// Looks at a map that another thread changes, without locks: a snapshot never changes while it is held.
///
/// ```
/// # use elbowroom_cspace::{Axis, Grid, JointMap, Obstacle, PlanarArm};
/// # use elbowroom_spatial::Vec3;
/// # let axis = |name: &str| Axis::from_degrees(name, -90.0, 90.0, 5.0);
/// # let grid = Grid::new([axis("base")?, axis("shoulder")?, axis("elbow")?])?;
/// let mut map = JointMap::new(PlanarArm::KR125_SIZED, &grid)?;
/// let mut reader = map.reader();
/// map.set("head", &Obstacle::sphere(Vec3::new(1.3, 0.4, 0.9), 0.25)?);
/// map.publish();
/// let watching = std::thread::spawn(move || {
///     let changes = reader.refresh(); // everything since this reader looked last
///     (changes.blocked(), reader.seen().blocked())
/// });
/// let (newly, now) = watching.join().unwrap();
/// assert!(newly > 0 && newly == now);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Reader {
    window: Arc<Window>,
    seen: Arc<Snapshot>,
}

impl Reader {
    pub(crate) fn new(window: Arc<Window>) -> Self {
        let seen = window.0.load_full();
        Self { window, seen }
    }

    /// The snapshot this reader looked at last.
    pub fn seen(&self) -> &Snapshot {
        &self.seen
    }

    /// Takes the newest snapshot.
    pub fn latest(&mut self) -> &Snapshot {
        self.seen = self.window.0.load_full();
        &self.seen
    }

    /// Takes the newest snapshot and tells exactly which cells changed since the one seen before, however many were
    /// published between.
    pub fn refresh(&mut self) -> Changes {
        let before = Arc::clone(&self.seen);
        self.latest();
        Changes::between(&before.table, &self.seen.table)
    }
}
