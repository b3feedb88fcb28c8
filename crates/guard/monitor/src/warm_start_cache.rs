//! Warm starts of the distance queries between meshes.

use elbowroom_proximity::{DistanceSettings, WarmStart, Workspace};
use elbowroom_proximity::{Separation, Shape, separation_within};
use elbowroom_spatial::Pose;

use crate::Configuration;

/// A warm start for every pair of a mesh volume and a mesh region, and the workspace of their queries.
#[derive(Debug)]
pub(crate) struct WarmStartCache {
    /// Row of each region that is a mesh.
    region_row: Vec<Option<usize>>,
    /// Column of each volume that is a mesh.
    volume_column: Vec<Option<usize>>,
    columns: usize,
    warm_starts: Vec<WarmStart>,
    workspace: Box<Workspace>,
}

/// A volume or region of the configuration: its index, its shape, and the pose of the shape in the world.
#[derive(Debug, Clone, Copy)]
pub(crate) struct IndexedShape<'a> {
    /// Index of the volume or region.
    pub(crate) index: usize,
    pub(crate) shape: &'a Shape,
    pub(crate) in_world: &'a Pose,
}

impl WarmStartCache {
    pub(crate) fn new(config: &Configuration) -> Self {
        let (region_row, rows) = number_meshes(config.regions.iter().map(|r| &r.shape));
        let (volume_column, columns) = number_meshes(config.volumes.iter().map(|v| &v.shape));
        let warm_starts = vec![WarmStart::default(); rows * columns];
        Self { region_row, volume_column, columns, warm_starts, workspace: Box::default() }
    }

    /// [`separation_within`] of a volume and a region.
    pub(crate) fn separation(
        &mut self,
        volume: IndexedShape<'_>,
        region: IndexedShape<'_>,
        limit: f64,
    ) -> Option<Separation> {
        let (a, a_in_world, b, b_in_world) = (volume.shape, volume.in_world, region.shape, region.in_world);
        match (self.region_row[region.index], self.volume_column[volume.index]) {
            (Some(row), Some(column)) => {
                let warm_start = &mut self.warm_starts[row * self.columns + column];
                let settings = DistanceSettings { limit, warm_start: Some(warm_start), ..DistanceSettings::default() };
                self.workspace.separation(a, a_in_world, b, b_in_world, settings)
            }
            _ => separation_within(a, a_in_world, b, b_in_world, limit),
        }
    }
}

/// Consecutive numbers for the shapes that are meshes, and their count.
fn number_meshes<'a>(shapes: impl Iterator<Item = &'a Shape>) -> (Vec<Option<usize>>, usize) {
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
