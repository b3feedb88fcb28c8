//! The surfaces of `Shape` nodes. Each face set is read once, however often it is used.

use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use elbowroom_spatial::Vec3;

use super::document::Document;
use super::values::Fields;
use super::{face_set, solids};
use crate::Diagnostic;
use crate::mesh_data::{MAX_ELEMENTS, MeshData};
use crate::tokens::show;
use crate::warning_list::WarningList;

type Result<T> = std::result::Result<T, Diagnostic>;

/// Largest number of points that the face sets of all files look at together.
const MAX_POINTS_READ: usize = 10 * MAX_ELEMENTS;

/// What all files have expanded to so far.
#[derive(Debug, Default)]
pub(super) struct Limits {
    elements: usize,
    points_read: usize,
}

impl Limits {
    /// Counts the vertices and triangles of an instance.
    pub(super) fn charge(&mut self, mesh: &MeshData, fields: Fields<'_, '_>) -> Result<()> {
        self.elements += mesh.vertices.len() + mesh.triangles.len();
        if self.elements <= MAX_ELEMENTS {
            return Ok(());
        }
        let what = format!("the scene expands to more than {MAX_ELEMENTS} vertices and triangles");
        Err(fields.error(what).hint("a coarser mesh, or fewer instances"))
    }

    fn charge_points(&mut self, count: usize, fields: Fields<'_, '_>) -> Result<()> {
        self.points_read += count;
        if self.points_read <= MAX_POINTS_READ {
            return Ok(());
        }
        let what = format!("the face sets refer to more than {MAX_POINTS_READ} points together");
        Err(fields.error(what).hint("coordinates of its own for every face set"))
    }
}

/// Reads the shapes of a document.
pub(super) struct ShapeReader<'a> {
    document: &'a Document<'a>,
    file: &'a Path,
    points: HashMap<usize, Rc<Vec<Vec3>>>,
    meshes: HashMap<usize, Rc<MeshData>>,
}

impl<'a> ShapeReader<'a> {
    pub(super) fn new(document: &'a Document<'a>, file: &'a Path) -> Self {
        Self { document, file, points: HashMap::new(), meshes: HashMap::new() }
    }

    fn fields(&self, index: usize) -> Fields<'a, 'a> {
        Fields { node: &self.document.nodes[index], file: self.file }
    }

    /// The triangles of a shape in its own frame; `None` if it has no surface.
    ///
    /// `scale` is the largest factor by which its group lengthens it.
    pub(super) fn read(
        &mut self,
        shape: usize,
        scale: f64,
        limits: &mut Limits,
        warnings: &mut WarningList,
    ) -> Result<Option<MeshData>> {
        let fields = self.fields(shape);
        let geometry = match fields.node.nodes("geometry") {
            [] => return Ok(None),
            [geometry] => *geometry,
            _ => return Err(fields.error("has several geometries").hint("one Shape for each geometry")),
        };
        let fields = self.fields(geometry);
        if let Some(solid) = solids::solid(fields, scale) {
            let mesh = solid?;
            limits.charge(&mesh, fields)?;
            return Ok(Some(mesh));
        }
        match fields.node.kind {
            b"IndexedFaceSet" | b"ElevationGrid" => {}
            b"IndexedLineSet" | b"PointSet" | b"Text" => {
                warnings.push(fields.error("has no surface; it is skipped").hint("an IndexedFaceSet"));
                return Ok(None);
            }
            other => {
                let known = "IndexedFaceSet, ElevationGrid, Box, Sphere, Cylinder or Cone";
                let what = format!("the geometry {} is not read, and its surface would be missing", show(other));
                return Err(Diagnostic::new(self.file, fields.node.line, what)
                    .hint(format!("{known}: export the part as triangles")));
            }
        }
        let mesh = self.face_set(geometry, fields, limits, warnings)?;
        limits.charge(&mesh, fields)?;
        Ok((!mesh.triangles.is_empty()).then(|| MeshData::clone(&mesh)))
    }

    fn face_set(
        &mut self,
        index: usize,
        fields: Fields<'a, 'a>,
        limits: &mut Limits,
        warnings: &mut WarningList,
    ) -> Result<Rc<MeshData>> {
        if let Some(mesh) = self.meshes.get(&index) {
            return Ok(Rc::clone(mesh));
        }
        let mesh = if fields.node.kind == b"ElevationGrid" {
            face_set::elevation_grid(fields, warnings)?
        } else {
            let points = self.coordinates(fields)?;
            limits.charge_points(points.len(), fields)?;
            face_set::indexed(fields, &points, warnings)?
        };
        let mesh = Rc::new(mesh);
        self.meshes.insert(index, Rc::clone(&mesh));
        Ok(mesh)
    }

    /// The points of the field `coord`.
    fn coordinates(&mut self, fields: Fields<'a, 'a>) -> Result<Rc<Vec<Vec3>>> {
        let [index] = *fields.node.nodes("coord") else { return Ok(Rc::default()) };
        if let Some(points) = self.points.get(&index) {
            return Ok(Rc::clone(points));
        }
        let coordinate = self.fields(index);
        if coordinate.node.kind != b"Coordinate" {
            let what = format!("coord is a {}", show(coordinate.node.kind));
            return Err(fields.error(what).hint("coord Coordinate { point [ … ] }"));
        }
        let points = Rc::new(coordinate.points("point")?);
        self.points.insert(index, Rc::clone(&points));
        Ok(points)
    }
}
