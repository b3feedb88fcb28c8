//! Stanford PLY: ASCII and both binary byte orders; polygons and triangle strips.

mod header;
mod values;

use std::path::Path;

use elbowroom_spatial::Vec3;

use crate::mesh::{LoadedMeshes, MeshData};
use crate::{FormatError, polygon, source};
use header::{Element, Header};
use values::Values;

/// Parses a PLY file. Numbers are taken as metres.
///
/// # Errors
/// Headers that make no sense, more elements announced than the file can hold, corners that do not exist, numbers
/// that are none.
pub fn parse(bytes: &[u8], file: &Path) -> Result<LoadedMeshes, FormatError> {
    source::check_content(bytes, file)?;
    let (header, body) = header::parse(bytes, file)?;
    let mut values = Values::new(body, header.encoding, header.lines, file);
    let mut mesh = MeshData { name: source::stem(file), ..MeshData::default() };
    let mut faces = Polygons::default();
    let mut strips = Polygons { are_strips: true, ..Polygons::default() };
    for element in &header.elements {
        values.check_room(element)?;
        match element.name.as_str() {
            "vertex" => {
                read_vertices(&mut values, element, file, &mut mesh.vertices)?;
                refuse_no_places(&values, &mesh.vertices)?;
            }
            "face" => faces.read(&mut values, element)?,
            "tristrips" => strips.read(&mut values, element)?,
            _ => skip(&mut values, element)?,
        }
    }
    faces.triangulate(&mut mesh, file)?;
    strips.triangulate(&mut mesh, file)?;
    refuse_bare_points(&header, &mesh, file)?;
    Ok(LoadedMeshes { meshes: vec![mesh], warnings: Vec::new() })
}

/// The vertices of a PLY file, faces or not, as they are written: sensors write NaN where they measured nothing. Numbers are
/// taken as metres.
///
/// ```
/// let text = b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n";
/// let points = elbowroom_formats::ply::parse_points(text, "one.ply".as_ref())?;
/// assert_eq!(points, [elbowroom_spatial::Vec3::new(1.0, 2.0, 3.0)]);
/// # Ok::<(), elbowroom_formats::FormatError>(())
/// ```
///
/// # Errors
/// Headers that make no sense, more elements announced than the file can hold, words that are no numbers.
pub fn parse_points(bytes: &[u8], file: &Path) -> Result<Vec<Vec3>, FormatError> {
    source::check_content(bytes, file)?;
    let (header, body) = header::parse(bytes, file)?;
    let mut values = Values::new(body, header.encoding, header.lines, file);
    let mut points = Vec::new();
    for element in &header.elements {
        values.check_room(element)?;
        if element.name == "vertex" {
            read_vertices(&mut values, element, file, &mut points)?;
            break;
        }
        skip(&mut values, element)?;
    }
    Ok(points)
}

fn refuse_no_places(values: &Values<'_>, vertices: &[Vec3]) -> Result<(), FormatError> {
    match vertices.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(i) => Err(values
            .error(format!("vertex {i} (from 0) is no place: {:?}", vertices[i]))
            .hint("finite numbers; export the mesh again")),
    }
}

fn refuse_bare_points(header: &Header, mesh: &MeshData, file: &Path) -> Result<(), FormatError> {
    if !mesh.triangles.is_empty() {
        return Ok(());
    }
    let what = format!("is a point cloud: {} vertices, no faces", mesh.vertices.len());
    Err(FormatError::new(file, header.line_of("face"), what)
        .hint("element face N and property list uchar int vertex_indices; or a mesh exported as a surface"))
}

fn skip(values: &mut Values<'_>, element: &Element) -> Result<(), FormatError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            values.skip(property)?;
        }
    }
    Ok(())
}

fn read_vertices(
    values: &mut Values<'_>,
    element: &Element,
    file: &Path,
    out: &mut Vec<Vec3>,
) -> Result<(), FormatError> {
    let mut axes = [usize::MAX; 3];
    for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
        let found = element.properties.iter().position(|p| p.name == name && p.list_count.is_none());
        *axis = found.ok_or_else(|| {
            FormatError::new(file, element.line, format!("the vertices have no {name}"))
                .hint(format!("property float {name}"))
        })?;
    }
    out.reserve(element.count);
    for _ in 0..element.count {
        let mut v = Vec3::ZERO.to_array();
        for (p, property) in element.properties.iter().enumerate() {
            match axes.iter().position(|&a| a == p) {
                Some(axis) => v[axis] = values.scalar(property.kind)?,
                None => values.skip(property)?,
            }
        }
        out.push(v.into());
    }
    Ok(())
}

/// Corner lists, kept until all vertices are known: faces may come first.
#[derive(Default)]
struct Polygons {
    are_strips: bool,
    corners: Vec<f64>,
    ends: Vec<usize>,
}

impl Polygons {
    fn read(&mut self, values: &mut Values<'_>, element: &Element) -> Result<(), FormatError> {
        let list = element
            .properties
            .iter()
            .position(|p| ["vertex_indices", "vertex_index"].contains(&p.name.as_str()) && p.list_count.is_some());
        let list = list.ok_or_else(|| {
            values
                .error_at(element.line, format!("the element `{}` does not list its vertices", element.name))
                .hint("property list uchar int vertex_indices")
        })?;
        for _ in 0..element.count {
            for (p, property) in element.properties.iter().enumerate() {
                if p == list {
                    values.list(property, &mut self.corners)?;
                    self.ends.push(self.corners.len());
                } else {
                    values.skip(property)?;
                }
            }
        }
        Ok(())
    }

    fn triangulate(&self, mesh: &mut MeshData, file: &Path) -> Result<(), FormatError> {
        let mut polygon_corners = Vec::new();
        let mut begin = 0;
        for (i, &end) in self.ends.iter().enumerate() {
            polygon_corners.clear();
            for &corner in &self.corners[begin..end] {
                let exists = corner >= 0.0 && corner < mesh.vertices.len() as f64;
                if exists {
                    polygon_corners.push(corner as u32);
                } else if self.are_strips && corner == -1.0 {
                    strip(&polygon_corners, &mut mesh.triangles);
                    polygon_corners.clear();
                } else {
                    let what = format!(
                        "face {i} (from 0) has the corner {corner}, but there are {} vertices",
                        mesh.vertices.len()
                    );
                    return Err(FormatError::new(file, None, what).hint("numbers of vertices, counted from 0"));
                }
            }
            if self.are_strips {
                strip(&polygon_corners, &mut mesh.triangles);
            } else {
                polygon::triangulate(&mesh.vertices, &polygon_corners, &mut mesh.triangles);
            }
            begin = end;
        }
        Ok(())
    }
}

/// Every corner from the third makes a triangle with the two before it; every other one is turned over.
pub(crate) fn strip(corners: &[u32], out: &mut Vec<[u32; 3]>) {
    out.extend(
        corners.windows(3).enumerate().map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] }),
    );
}
