//! The joint map: one layer per obstacle, one table for all.

use std::sync::Arc;

use crate::layer::group;
use crate::reader::{Reader, Snapshot, Window};
use crate::{Cell, Changes, FillError, Filler, Grid, Layer, Obstacle, PlanarArm, Span, Table};

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
    layers: Vec<(String, Layer)>,
    /// What never moves.
    fixed: Table,
    table: Table,
    changes: Changes,
    /// The last update's new layer, then the one it replaced: memory that is used again.
    spare: Layer,
    row: Vec<u64>,
    version: u64,
    window: Arc<Window>,
}

impl JointMap {
    /// A map without obstacles.
    ///
    /// # Errors
    /// As [`Filler::new`].
    pub fn new(arm: PlanarArm, grid: &Grid) -> Result<Self, FillError> {
        let filler = Filler::new(arm, grid)?;
        let table = Table::new(grid.shape());
        Ok(Self {
            filler,
            layers: Vec::new(),
            fixed: table.clone(),
            row: vec![0; table.words_per_row()],
            changes: Changes::default(),
            spare: Layer::new(),
            version: 0,
            window: Arc::new(Window::new(Snapshot { table: table.clone(), version: 0 })),
            table,
        })
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        self.filler.grid()
    }

    /// The table of all layers together.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// Names and layers of the obstacles, in the order in which they entered.
    pub fn layers(&self) -> impl Iterator<Item = (&str, &Layer)> {
        self.layers.iter().map(|(name, layer)| (name.as_str(), layer))
    }

    /// True where a configuration (radians) lies in a blocked cell, and where it lies outside the limits.
    pub fn is_blocked(&self, q: [f64; 3]) -> bool {
        self.grid().cell(q).is_none_or(|cell: Cell| self.table.is_blocked(cell))
    }

    /// An obstacle enters, or moves if one of this name is there; the cells that changed.
    pub fn set(&mut self, name: &str, obstacle: &Obstacle) -> &Changes {
        let mut layer = std::mem::take(&mut self.spare);
        self.filler.fill(obstacle, &mut layer);
        self.set_layer(name, layer)
    }

    /// The same with a layer that was made elsewhere, for the same grid.
    pub fn set_layer(&mut self, name: &str, layer: Layer) -> &Changes {
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

    /// An obstacle leaves; `None` where there was none of this name.
    pub fn remove(&mut self, name: &str) -> Option<&Changes> {
        let index = self.layers.iter().position(|(other, _)| other == name)?;
        let old = std::mem::take(&mut self.layers[index].1);
        self.update(index, &old);
        self.layers.remove(index);
        self.spare = old;
        Some(&self.changes)
    }

    /// Blocks cells for good: the cell's fixtures, walls and floor.
    pub fn set_fixed(&mut self, obstacles: &[Obstacle]) -> Changes {
        let before = self.table.clone();
        let mut fixed = Table::new(self.grid().shape());
        let mut layer = Layer::new();
        for obstacle in obstacles {
            self.filler.fill(obstacle, &mut layer);
            fixed.add(&layer);
        }
        self.table = fixed.clone();
        self.fixed = fixed;
        for (_, layer) in &self.layers {
            self.table.add(layer);
        }
        Changes::between(&before, &self.table)
    }

    /// Makes the present table the one that readers see.
    pub fn publish(&mut self) {
        self.version += 1;
        self.window.show(Snapshot { table: self.table.clone(), version: self.version });
    }

    /// A view for another thread: what was published last.
    pub fn reader(&self) -> Reader {
        Reader::new(Arc::clone(&self.window))
    }

    /// Writes the rows in which a layer differs from what it was.
    fn update(&mut self, index: usize, old: &Layer) {
        self.changes.restart(self.table.shape());
        let (mut was, mut now) = (old.spans(), self.layers[index].1.spans());
        let mut others: Vec<&[Span]> =
            self.layers.iter().enumerate().filter(|&(i, _)| i != index).map(|(_, (_, l))| l.spans()).collect();
        let [planes, rows, _] = self.table.shape();
        let width = self.table.words_per_row();
        let (mut plane, mut words): (usize, &mut [u64]) = (usize::MAX, &mut []);
        while let Some(row) = first_row(was, now) {
            let (before, after) = (group(&mut was, row), group(&mut now, row));
            // A layer made for another grid may know rows that this one has not.
            if before == after || row as usize >= rows * planes {
                continue;
            }
            self.row.copy_from_slice(self.fixed.row(row as usize));
            let from_others = others.iter_mut().flat_map(|spans| group(spans, row));
            for &span in after.iter().chain(from_others) {
                self.fixed.mark_in(&mut self.row, span);
            }
            if row as usize / rows != plane {
                plane = row as usize / rows;
                words = self.table.plane_mut(plane);
            }
            let there = &mut words[(row as usize - plane * rows) * width..][..width];
            self.changes.note(row as usize, there, &self.row);
            there.copy_from_slice(&self.row);
        }
    }
}

fn first_row(a: &[Span], b: &[Span]) -> Option<u32> {
    match (a.first(), b.first()) {
        (Some(a), Some(b)) => Some(a.row.min(b.row)),
        (one, other) => one.or(other).map(|span| span.row),
    }
}
