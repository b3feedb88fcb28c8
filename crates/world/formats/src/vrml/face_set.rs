//! `IndexedFaceSet` and `ElevationGrid`: polygons as triangles.

use elbowroom_spatial::Vec3;

use super::values::Fields;
use crate::mesh_data::{MAX_ELEMENTS, MeshData, split_vertices};
use crate::tokens::{integer, show};
use crate::warning_list::WarningList;
use crate::{Diagnostic, polygon};

/// Reads the triangles of an `IndexedFaceSet` with the points of its `coord`.
pub(super) fn indexed(
    fields: Fields<'_, '_>,
    points: &[Vec3],
    warnings: &mut WarningList,
) -> Result<MeshData, Diagnostic> {
    let mut mesh = MeshData::default();
    let mut face = Face { corners: Vec::new(), line: fields.node.line };
    for (word, line) in fields.words("coordIndex")? {
        match integer(word) {
            Some(-1) => face.finish(fields, points, &mut mesh, warnings),
            Some(index) if usize::try_from(index).is_ok_and(|i| i < points.len()) => {
                if face.corners.is_empty() {
                    face.line = line;
                }
                face.corners.push(index as u32);
            }
            _ => {
                let what = format!("`{}` in coordIndex is no point: the coordinates have {}", show(word), points.len());
                return Err(Diagnostic::new(fields.file, line, what)
                    .hint("the number of a point, counted from 0; -1 at the end of a polygon"));
            }
        }
    }
    if !face.corners.is_empty() {
        face.finish(fields, points, &mut mesh, warnings);
    }
    if mesh.triangles.is_empty() {
        warnings.push(fields.error("has no polygon in coordIndex, so no surface").hint("coordIndex [ 0 1 2 -1 ]"));
    }
    if !fields.boolean("ccw", true)? {
        mesh.flip();
    }
    split_vertices(points, std::slice::from_mut(&mut mesh));
    Ok(mesh)
}

/// A polygon and the line on which it begins.
struct Face {
    corners: Vec<u32>,
    line: usize,
}

impl Face {
    fn finish(&mut self, fields: Fields<'_, '_>, points: &[Vec3], mesh: &mut MeshData, warnings: &mut WarningList) {
        if self.corners.len() < 3 {
            warnings.push_with(|| {
                let what = format!("a polygon of {} corners has no surface", self.corners.len());
                Diagnostic::new(fields.file, self.line, what).hint("three corners or more before each -1")
            });
        }
        polygon::triangulate(points, &self.corners, &mut mesh.triangles);
        self.corners.clear();
    }
}

/// Reads an `ElevationGrid`: heights along y over a grid in x and z, with two triangles per cell.
pub(super) fn elevation_grid(fields: Fields<'_, '_>, warnings: &mut WarningList) -> Result<MeshData, Diagnostic> {
    let heights = fields.numbers("height")?;
    let size = |name: &str| {
        let value = fields.integer(name, 0)?;
        usize::try_from(value).ok().filter(|n| *n <= MAX_ELEMENTS).ok_or_else(|| {
            fields.error(format!("{name} is {value}")).hint("the number of heights in this direction, 2 or more")
        })
    };
    let (columns, rows) = (size("xDimension")?, size("zDimension")?);
    if columns.saturating_mul(rows) != heights.len() {
        let what = format!("has {} heights for xDimension {columns} and zDimension {rows}", heights.len());
        return Err(fields.error(what).hint("xDimension times zDimension heights"));
    }
    if columns < 2 || rows < 2 {
        warnings.push(fields.error("has no cell, so no surface").hint("xDimension 2 and zDimension 2, or more"));
        return Ok(MeshData::default());
    }
    let (dx, dz) = (fields.length("xSpacing", 1.0)?, fields.length("zSpacing", 1.0)?);
    let point = |(i, height): (usize, &f64)| Vec3::new(dx * (i % columns) as f64, *height, dz * (i / columns) as f64);
    let vertices: Vec<Vec3> = heights.iter().enumerate().map(point).collect();
    let mut mesh = MeshData { name: String::new(), vertices, triangles: Vec::new() };
    for (row, column) in (1..rows).flat_map(|row| (1..columns).map(move |column| (row, column))) {
        let at = |row: usize, column: usize| (row * columns + column) as u32;
        let cell = [at(row - 1, column - 1), at(row, column - 1), at(row, column), at(row - 1, column)];
        polygon::fan(&cell, &mut mesh.triangles);
    }
    if !fields.boolean("ccw", true)? {
        mesh.flip();
    }
    Ok(mesh)
}
