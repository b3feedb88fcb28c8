//! Layers by name over one grid, one table for all.

use std::sync::Arc;

use crate::layer::group;
use crate::reader::{Reader, Snapshot, Window};
use crate::table::mark_row;
use crate::{Cell, Changes, Grid, Layer, Span, Table};

/// What obstacles block, each in a layer of its own, whoever fills them: a [`RobotFiller`](crate::RobotFiller) by way of
/// [`Blocks::layer`](crate::Blocks::layer), or a [`JointMap`](crate::JointMap), which has a [`Filler`](crate::Filler) to it.
///
/// One thread owns the map and changes it; any number of threads look at it through a [`Reader`].
///
/// ```
/// use elbowroom_cspace::{Axis, Grid, LayerMap, Others, RobotFiller};
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_scene::example;
/// use elbowroom_spatial::{Pose, Vec3};
/// let grid = Grid::new(["a", "b", "c"].map(|name| Axis::from_degrees(name, -90.0, 90.0, 6.0).unwrap()))?;
/// let filler = RobotFiller::new(&example::arm()?, Pose::IDENTITY, grid.axes(), &[0, 1, 2], Others::Any)?;
/// let mut map = LayerMap::new(&grid);
/// let mut ball_at = |x: f64, map: &mut LayerMap| {
///     let ball = (Shape::Sphere(Sphere { radius: 0.1 }), Pose::from_translation(Vec3::new(x, 0.0, 0.6)));
///     let layer = filler.fill(&[ball])?.layer(&grid).expect("the same axes");
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
    /// What never moves.
    fixed: Table,
    table: Table,
    changes: Changes,
    /// The last update's new layer, then the one it replaced: memory that is used again.
    pub(crate) spare: Layer,
    row: Vec<u64>,
    version: u64,
    window: Arc<Window>,
}

impl LayerMap {
    /// A map that blocks nothing.
    pub fn new(grid: &Grid) -> Self {
        let table = Table::new(grid.shape());
        Self {
            grid: grid.clone(),
            layers: Vec::new(),
            fixed: table.clone(),
            row: vec![0; table.words_per_row()],
            changes: Changes::default(),
            spare: Layer::new(),
            version: 0,
            window: Arc::new(Window::new(Snapshot { table: table.clone(), version: 0 })),
            table,
        }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
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
        self.grid.cell(q).is_none_or(|cell: Cell| self.table.is_blocked(cell))
    }

    /// An obstacle enters, or moves if one of this name is there, as a layer made for this grid; the cells that changed.
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

    /// Blocks cells for good, instead of those that it was told before.
    pub fn set_fixed(&mut self, layers: &[Layer]) -> Changes {
        let before = self.table.clone();
        let mut fixed = Table::new(self.grid.shape());
        for layer in layers {
            fixed.add(layer);
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
        match self.table.words_per_row() {
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

    /// With rows of `W` words.
    fn update_short<const W: usize>(&mut self, index: usize, old: &Layer) {
        let Self { fixed, table, changes, layers, .. } = self;
        let masks = fixed.masks::<W>();
        let (mut changed, mut others) = (Changed::new(old, &layers[index].1, table), others(layers, index));
        let rows = table.shape()[1] as u32;
        let (mut first, mut end, mut words): (u32, u32, &mut [[u64; W]]) = (0, 0, &mut []);
        let mut below: &[[u64; W]] = &[];
        while let Some((row, after)) = changed.next() {
            if row >= end {
                let plane = row / rows;
                (first, end) = (plane * rows, (plane + 1) * rows);
                words = table.plane_mut(plane as usize).as_chunks_mut().0;
                below = fixed.plane(plane as usize).as_chunks().0;
            }
            let mut now = below[(row - first) as usize];
            for &span in after {
                masks.mark(&mut now, span);
            }
            for spans in &mut others {
                for &span in group(spans, row) {
                    masks.mark(&mut now, span);
                }
            }
            let was = &mut words[(row - first) as usize];
            changes.note(row as usize, was, &now);
            *was = now;
        }
    }

    fn update_long(&mut self, index: usize, old: &Layer) {
        let Self { fixed, table, changes, layers, row: now, .. } = self;
        let (mut changed, mut others) = (Changed::new(old, &layers[index].1, table), others(layers, index));
        let (rows, width, last) = (table.shape()[1], table.words_per_row(), table.shape()[2] as u16 - 1);
        while let Some((row, after)) = changed.next() {
            now.copy_from_slice(fixed.row(row as usize));
            for span in after.iter().chain(others.iter_mut().flat_map(|spans| group(spans, row))) {
                mark_row(now, span.first, span.last.min(last));
            }
            let was = &mut table.plane_mut(row as usize / rows)[row as usize % rows * width..][..width];
            changes.note(row as usize, was, now);
            was.copy_from_slice(now);
        }
    }
}

/// All spans but those of one layer.
fn others(layers: &[(String, Layer)], index: usize) -> Vec<&[Span]> {
    layers.iter().enumerate().filter(|&(i, _)| i != index).map(|(_, (_, layer))| layer.spans()).collect()
}

/// Rows in which two layers differ.
struct Changed<'a> {
    was: &'a [Span],
    now: &'a [Span],
    /// A layer made for another grid may know rows that this one has not.
    rows: u32,
}

impl<'a> Changed<'a> {
    fn new(was: &'a Layer, now: &'a Layer, table: &Table) -> Self {
        Self { was: was.spans(), now: now.spans(), rows: (table.shape()[0] * table.shape()[1]) as u32 }
    }

    /// The next row, and its new spans.
    #[inline]
    fn next(&mut self) -> Option<(u32, &'a [Span])> {
        while let Some(row) = first_row(self.was, self.now).filter(|&row| row < self.rows) {
            let (before, after) = (group(&mut self.was, row), group(&mut self.now, row));
            if before != after {
                return Some((row, after));
            }
        }
        None
    }
}

fn first_row(a: &[Span], b: &[Span]) -> Option<u32> {
    match (a.first(), b.first()) {
        (Some(a), Some(b)) => Some(a.row.min(b.row)),
        (one, other) => one.or(other).map(|span| span.row),
    }
}
