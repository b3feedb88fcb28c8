//! Occupancy map: named layers over one grid, and their union.

use std::sync::Arc;

use crate::bits::set_range;
use crate::layer::take_row;
use crate::map_reader::{MapReader, MapSnapshot, PublishedMap};
use crate::{CellChanges, CellIndex, Grid, Layer, OccupancyBitmap, RowSpan};

/// Blocked cells of obstacles, one layer per obstacle. Layers come from a [`RobotMapBuilder`](crate::RobotMapBuilder)
/// by [`BoxTree::to_layer`](crate::BoxTree::to_layer), or from a [`PlanarMapBuilder`](crate::PlanarMapBuilder), which a
/// [`JointMap`](crate::JointMap) contains.
///
/// One thread owns the map and changes it; any number of threads read it through a [`MapReader`].
///
/// ```
/// use elbowroom_cspace::{Grid, GridAxis, LayerMap, RemainingJoints, RobotMapBuilder};
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_robot::example;
/// use elbowroom_spatial::{Pose, Vec3};
/// let grid = Grid::new(["a", "b", "c"].map(|name| GridAxis::from_degrees(name, -90.0, 90.0, 6.0).unwrap()))?;
/// let (robot, joints) = (example::arm()?, [0, 1, 2]);
/// let builder = RobotMapBuilder::new(&robot, Pose::IDENTITY, grid.axes(), &joints, RemainingJoints::Swept)?;
/// let mut map = LayerMap::new(&grid);
/// let mut ball_at = |x: f64, map: &mut LayerMap| {
///     let ball = (Shape::Sphere(Sphere { radius: 0.1 }), Pose::from_translation(Vec3::new(x, 0.0, 0.6)));
///     let layer = builder.build(&[ball])?.to_layer(&grid).expect("the same axes");
///     let changes = map.set_layer("ball", layer);
///     Ok::<_, Box<dyn std::error::Error>>((changes.blocked(), changes.freed()))
/// };
/// let (entered, _) = ball_at(0.6, &mut map)?;
/// let (more, less) = ball_at(0.61, &mut map)?;
/// assert!(more + less < entered);
/// map.publish();
/// assert_eq!(map.reader().latest().blocked(), entered + more - less);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct LayerMap {
    grid: Grid,
    layers: Vec<(String, Layer)>,
    /// Occupancy of the static obstacles.
    fixed: OccupancyBitmap,
    /// Union of `fixed` and all layers.
    occupancy: OccupancyBitmap,
    changes: CellChanges,
    /// The layer that the last update replaced, whose memory is reused.
    pub(crate) spare: Layer,
    row: Vec<u64>,
    version: u64,
    published: Arc<PublishedMap>,
}

impl LayerMap {
    /// Creates a map without blocked cells.
    pub fn new(grid: &Grid) -> Self {
        let occupancy = OccupancyBitmap::new(grid.shape());
        Self {
            grid: grid.clone(),
            layers: Vec::new(),
            fixed: occupancy.clone(),
            row: vec![0; occupancy.words_per_row()],
            changes: CellChanges::default(),
            spare: Layer::new(),
            version: 0,
            published: Arc::new(PublishedMap::new(MapSnapshot { occupancy: occupancy.clone(), version: 0 })),
            occupancy,
        }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The occupancy of all layers together.
    pub fn occupancy(&self) -> &OccupancyBitmap {
        &self.occupancy
    }

    /// Names and layers of the obstacles, in the order in which they were added.
    pub fn layers(&self) -> impl Iterator<Item = (&str, &Layer)> {
        self.layers.iter().map(|(name, layer)| (name.as_str(), layer))
    }

    /// Whether a configuration (radians) is in a blocked cell or outside the limits.
    pub fn is_blocked(&self, q: [f64; 3]) -> bool {
        self.grid.cell(q).is_none_or(|cell: CellIndex| self.occupancy.is_blocked(cell))
    }

    /// Adds an obstacle as a layer built for this grid, or replaces the obstacle of this name; returns the cells that
    /// changed.
    pub fn set_layer(&mut self, name: &str, layer: Layer) -> &CellChanges {
        let known = self.layers.iter().position(|(other, _)| other == name);
        let index = known.unwrap_or_else(|| {
            self.layers.push((name.to_owned(), Layer::new()));
            self.layers.len() - 1
        });
        let old = std::mem::replace(&mut self.layers[index].1, layer);
        self.update(index, &old);
        self.spare = old;
        &self.changes
    }

    /// Removes an obstacle; `None` if the map has no obstacle of this name.
    pub fn remove(&mut self, name: &str) -> Option<&CellChanges> {
        let index = self.layers.iter().position(|(other, _)| other == name)?;
        let old = std::mem::take(&mut self.layers[index].1);
        self.update(index, &old);
        self.layers.remove(index);
        self.spare = old;
        Some(&self.changes)
    }

    /// Replaces the layers of static obstacles; returns the cells that changed.
    pub fn set_fixed(&mut self, layers: &[Layer]) -> CellChanges {
        let before = self.occupancy.clone();
        let mut fixed = OccupancyBitmap::new(self.grid.shape());
        for layer in layers {
            fixed.add(layer);
        }
        self.occupancy = fixed.clone();
        self.fixed = fixed;
        for (_, layer) in &self.layers {
            self.occupancy.add(layer);
        }
        CellChanges::between(&before, &self.occupancy)
    }

    /// Publishes the current occupancy to readers.
    pub fn publish(&mut self) {
        self.version += 1;
        self.published.store(MapSnapshot { occupancy: self.occupancy.clone(), version: self.version });
    }

    /// Creates a reader of the published occupancy, for another thread.
    pub fn reader(&self) -> MapReader {
        MapReader::new(Arc::clone(&self.published))
    }

    /// Updates the rows in which a layer differs from its previous state.
    fn update(&mut self, index: usize, old: &Layer) {
        self.changes.reset(self.occupancy.shape());
        match self.occupancy.words_per_row() {
            1 => self.update_short::<1>(index, old),
            2 => self.update_short::<2>(index, old),
            3 => self.update_short::<3>(index, old),
            4 => self.update_short::<4>(index, old),
            5 => self.update_short::<5>(index, old),
            6 => self.update_short::<6>(index, old),
            7 => self.update_short::<7>(index, old),
            8 => self.update_short::<8>(index, old),
            _ => self.update_long(index, old),
        }
    }

    /// Updates rows of `W` words.
    fn update_short<const W: usize>(&mut self, index: usize, old: &Layer) {
        let Self { fixed, occupancy, changes, layers, .. } = self;
        let masks = fixed.masks::<W>();
        let (mut changed, mut others) = (ChangedRows::new(old, &layers[index].1, occupancy), others(layers, index));
        let rows = occupancy.shape()[1] as u32;
        let (mut first, mut end, mut words): (u32, u32, &mut [[u64; W]]) = (0, 0, &mut []);
        let mut below: &[[u64; W]] = &[];
        while let Some((row, after)) = changed.next() {
            if row >= end {
                let plane = row / rows;
                (first, end) = (plane * rows, (plane + 1) * rows);
                words = occupancy.plane_mut(plane as usize).as_chunks_mut().0;
                below = fixed.plane(plane as usize).as_chunks().0;
            }
            let mut now = below[(row - first) as usize];
            for &span in after {
                masks.mark(&mut now, span);
            }
            for spans in &mut others {
                for &span in take_row(spans, row) {
                    masks.mark(&mut now, span);
                }
            }
            let was = &mut words[(row - first) as usize];
            changes.record_row(row as usize, was, &now);
            *was = now;
        }
    }

    fn update_long(&mut self, index: usize, old: &Layer) {
        let Self { fixed, occupancy, changes, layers, row: now, .. } = self;
        let (mut changed, mut others) = (ChangedRows::new(old, &layers[index].1, occupancy), others(layers, index));
        let (rows, width, last) = (occupancy.shape()[1], occupancy.words_per_row(), occupancy.shape()[2] as u16 - 1);
        while let Some((row, after)) = changed.next() {
            now.copy_from_slice(fixed.row(row as usize));
            for span in after.iter().chain(others.iter_mut().flat_map(|spans| take_row(spans, row))) {
                set_range(now, span.first, span.last.min(last));
            }
            let was = &mut occupancy.plane_mut(row as usize / rows)[row as usize % rows * width..][..width];
            changes.record_row(row as usize, was, now);
            was.copy_from_slice(now);
        }
    }
}

/// The spans of all layers except one.
fn others(layers: &[(String, Layer)], index: usize) -> Vec<&[RowSpan]> {
    layers.iter().enumerate().filter(|&(i, _)| i != index).map(|(_, (_, layer))| layer.spans()).collect()
}

/// Iterates over the rows in which two layers differ.
struct ChangedRows<'a> {
    was: &'a [RowSpan],
    now: &'a [RowSpan],
    /// Number of rows of the grid: a layer built for another grid may have more rows.
    rows: u32,
}

impl<'a> ChangedRows<'a> {
    fn new(was: &'a Layer, now: &'a Layer, occupancy: &OccupancyBitmap) -> Self {
        Self { was: was.spans(), now: now.spans(), rows: (occupancy.shape()[0] * occupancy.shape()[1]) as u32 }
    }

    /// The next row and its new spans.
    #[inline]
    fn next(&mut self) -> Option<(u32, &'a [RowSpan])> {
        while let Some(row) = first_row(self.was, self.now).filter(|&row| row < self.rows) {
            let (before, after) = (take_row(&mut self.was, row), take_row(&mut self.now, row));
            if before != after {
                return Some((row, after));
            }
        }
        None
    }
}

fn first_row(a: &[RowSpan], b: &[RowSpan]) -> Option<u32> {
    match (a.first(), b.first()) {
        (Some(a), Some(b)) => Some(a.row.min(b.row)),
        (one, other) => one.or(other).map(|span| span.row),
    }
}
