//! All regions of a file, and one region that the file does not have.

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Data, Entry, Node, Table};

use super::definitions::Definitions;
use super::document::REGION_TABLES;
use super::{guarding, region};
use crate::{Cell, CellRegion, CellRegionId, PoseTrack};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Reads the regions of a cell whose robots, encoders and objects are known, with the pose files that they follow.
pub(super) fn read(
    root: &Table<'_>,
    cell: &Cell,
    warnings: &mut Vec<Diagnostic>,
) -> Result<(Vec<CellRegion>, Vec<PoseTrack>)> {
    let mut known = Definitions {
        robots: &cell.robots,
        encoders: &cell.frame_sources.encoders,
        objects: &cell.objects,
        moving_objects: &cell.moving_objects,
        pose_tracks: Vec::new(),
    };
    let mut regions = Vec::new();
    for table in region::tables(root)? {
        regions.push(table.read(cell.units, &mut known, warnings)?);
    }
    Ok((regions, known.pose_tracks))
}

/// The cell with one region in place of its own. Only this region is read, and checked against what it guards.
///
/// # Errors
/// [`Diagnostic`] for the keys of the region.
pub(crate) fn with_only_region(cell: &Cell, name: &str, is_fence: bool, keys: Vec<Entry>) -> Result<Cell> {
    let entry =
        |key: &str, entries| Entry { key: key.into(), line: 1, node: Node { line: 1, data: Data::Table(entries) } };
    let entries = [entry(REGION_TABLES[usize::from(is_fence)], vec![entry(name, keys)])];
    let root = Table { file: &cell.file, name: String::new(), line: 1, entries: &entries };
    let (regions, pose_tracks) = read(&root, cell, &mut Vec::new())?;
    let mut alone = Cell { regions, ..cell.clone() };
    alone.frame_sources.pose_tracks = pose_tracks;
    for (t, index) in region::tables(&root)?.into_iter().zip(0..) {
        guarding::check(&t.table, &alone, CellRegionId(index), &mut Vec::new())?;
    }
    Ok(alone)
}
