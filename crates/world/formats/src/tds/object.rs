//! Objects: vertices, faces and local axes.

use std::path::Path;

use elbowroom_spatial::Vec3;

use super::chunk::{Chunk, Cursor};
use crate::Diagnostic;
use crate::affine::Affine;

/// A mesh as in the file.
pub(super) struct Object {
    pub(super) name: String,
    /// Vertices in world coordinates or in the object's frame: see [`super::assemble`].
    pub(super) vertices: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The object's frame in the world, which may scale and mirror; `None` if the file has none.
    pub(super) axes: Option<Affine>,
}

/// Reads an object; `None` for cameras and lights.
pub(super) fn read(chunk: &Chunk<'_>, file: &Path) -> Result<Option<Object>, Diagnostic> {
    let mut cursor = chunk.cursor(file);
    let name = cursor.text()?;
    for child in cursor.children() {
        let child = child?;
        if child.id == 0x4100 {
            return mesh(name, &child, file).map(Some);
        }
    }
    Ok(None)
}

fn mesh(name: String, chunk: &Chunk<'_>, file: &Path) -> Result<Object, Diagnostic> {
    let mut object = Object { name, vertices: Vec::new(), triangles: Vec::new(), axes: None };
    for child in chunk.children(file) {
        let child = child?;
        let mut cursor = child.cursor(file);
        match child.id {
            0x4110 => object.vertices = vertices(&mut cursor)?,
            0x4120 => object.triangles = triangles(&mut cursor)?,
            0x4160 => object.axes = Some(axes(&mut cursor)?),
            _ => {}
        }
    }
    let count = object.vertices.len();
    if let Some(bad) = object.triangles.iter().flatten().find(|&&i| i as usize >= count) {
        let what = format!("a face of `{}` has the corner {bad}, but there are {count} vertices", object.name);
        return Err(Diagnostic::new(file, None, what).hint("the model exported again, or the object left out"));
    }
    Ok(object)
}

fn vertices(cursor: &mut Cursor<'_, '_>) -> Result<Vec<Vec3>, Diagnostic> {
    let count = usize::from(cursor.u16()?);
    let count = cursor.count(count, 12, "vertices")?;
    (0..count).map(|_| cursor.vector()).collect()
}

fn triangles(cursor: &mut Cursor<'_, '_>) -> Result<Vec<[u32; 3]>, Diagnostic> {
    let count = usize::from(cursor.u16()?);
    let count = cursor.count(count, 8, "faces")?;
    let mut corner = || cursor.u16().map(u32::from);
    let mut face = || Ok([corner()?, corner()?, corner()?, corner()?]);
    // The fourth number selects the visible edges.
    (0..count).map(|_| face().map(|[a, b, c, _]| [a, b, c])).collect()
}

/// Reads three axes and the origin, as columns.
fn axes(cursor: &mut Cursor<'_, '_>) -> Result<Affine, Diagnostic> {
    let (x, y, z, origin) = (cursor.vector()?, cursor.vector()?, cursor.vector()?, cursor.vector()?);
    let row = |i: usize| [x, y, z, origin].map(|v| v.to_array()[i]);
    Ok(Affine([row(0), row(1), row(2)]))
}
