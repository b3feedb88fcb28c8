//! Where pairs of meshes were nearest in the tick before.

use elbowroom_proximity::mesh::{Hint, Scratch};
use elbowroom_proximity::{Separation, Shape, separation_within};
use elbowroom_spatial::Pose;

use crate::Configuration;

/// A hint for every volume and region that both are meshes, and the memory of their queries.
#[derive(Debug)]
pub(crate) struct Witnesses {
    /// Numbers among the meshes, of regions and of volumes.
    row: Vec<Option<usize>>,
    column: Vec<Option<usize>>,
    columns: usize,
    hints: Vec<Hint>,
    scratch: Box<Scratch>,
}

impl Witnesses {
    pub(crate) fn new(config: &Configuration) -> Self {
        let (row, rows) = numbered(config.regions.iter().map(|r| &r.shape));
        let (column, columns) = numbered(config.volumes.iter().map(|v| &v.shape));
        Self { row, column, columns, hints: vec![Hint::default(); rows * columns], scratch: Box::default() }
    }

    /// [`separation_within`] of a volume and a region.
    pub(crate) fn separation(
        &mut self,
        (v, volume, in_world): (usize, &Shape, &Pose),
        (r, region, region_in_world): (usize, &Shape, &Pose),
        limit: f64,
    ) -> Option<Separation> {
        match (self.row[r], self.column[v]) {
            (Some(row), Some(column)) => {
                let hint = &mut self.hints[row * self.columns + column];
                self.scratch.separation(volume, in_world, region, region_in_world, limit, hint)
            }
            _ => separation_within(volume, in_world, region, region_in_world, limit),
        }
    }
}

fn numbered<'a>(shapes: impl Iterator<Item = &'a Shape>) -> (Vec<Option<usize>>, usize) {
    let mut count = 0;
    let mut number = |shape: &Shape| {
        matches!(shape, Shape::Mesh(_)).then(|| {
            count += 1;
            count - 1
        })
    };
    let numbers = shapes.map(&mut number).collect();
    (numbers, count)
}
