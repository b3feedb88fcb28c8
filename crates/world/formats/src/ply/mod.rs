//! Stanford PLY: ASCII and both binary byte orders; polygons and triangle strips.

mod body;
mod header;

use std::path::Path;

use elbowroom_spatial::Vec3;

use crate::mesh_data::{LoadedMeshes, MeshData};
use crate::{Diagnostic, input, polygon};
use body::BodyReader;
use header::{Element, Header};

/// Parses a PLY file. Numbers are metres.
///
/// # Errors
/// [`Diagnostic`] for invalid headers, declared counts that the file cannot hold, missing vertices, or invalid numbers.
pub fn parse(bytes: &[u8], file: &Path) -> Result<LoadedMeshes, Diagnostic> {
    input::check_content(bytes, file)?;
    let (header, body) = header::parse(bytes, file)?;
    let mut body_reader = BodyReader::new(body, header.encoding, header.lines, file);
    let mut mesh = MeshData { name: input::stem(file), ..MeshData::default() };
    let mut faces = FaceLists::default();
    let mut strips = FaceLists { are_strips: true, ..FaceLists::default() };
    for element in &header.elements {
        body_reader.check_remaining(element)?;
        match element.name.as_str() {
            "vertex" => {
                read_vertices(&mut body_reader, element, file, &mut mesh.vertices)?;
                refuse_non_finite(&body_reader, &mesh.vertices)?;
            }
            "face" => faces.read(&mut body_reader, element)?,
            "tristrips" => strips.read(&mut body_reader, element)?,
            _ => skip(&mut body_reader, element)?,
        }
    }
    faces.triangulate(&mut mesh, file)?;
    strips.triangulate(&mut mesh, file)?;
    refuse_point_cloud(&header, &mesh, file)?;
    Ok(LoadedMeshes { meshes: vec![mesh], warnings: Vec::new() })
}

/// Parses the vertices of a PLY file as written, with or without faces.
///
/// Numbers are metres; sensors write NaN for points that they did not measure.
///
/// ```
/// let text = b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 3\n";
/// let points = elbowroom_formats::ply::parse_points(text, "one.ply".as_ref())?;
/// assert_eq!(points, [elbowroom_spatial::Vec3::new(1.0, 2.0, 3.0)]);
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
///
/// # Errors
/// [`Diagnostic`] for invalid headers, declared counts that the file cannot hold, or words that are not numbers.
pub fn parse_points(bytes: &[u8], file: &Path) -> Result<Vec<Vec3>, Diagnostic> {
    input::check_content(bytes, file)?;
    let (header, body) = header::parse(bytes, file)?;
    let mut body_reader = BodyReader::new(body, header.encoding, header.lines, file);
    let mut points = Vec::new();
    for element in &header.elements {
        body_reader.check_remaining(element)?;
        if element.name == "vertex" {
            read_vertices(&mut body_reader, element, file, &mut points)?;
            break;
        }
        skip(&mut body_reader, element)?;
    }
    Ok(points)
}

fn refuse_non_finite(body_reader: &BodyReader<'_>, vertices: &[Vec3]) -> Result<(), Diagnostic> {
    match vertices.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(i) => Err(body_reader
            .error(format!("vertex {i} (from 0) is not finite: {:?}", vertices[i]))
            .hint("finite numbers; export the mesh again")),
    }
}

fn refuse_point_cloud(header: &Header, mesh: &MeshData, file: &Path) -> Result<(), Diagnostic> {
    if !mesh.triangles.is_empty() {
        return Ok(());
    }
    let what = format!("is a point cloud: {} vertices, no faces", mesh.vertices.len());
    Err(Diagnostic::new(file, header.line_of("face"), what)
        .hint("element face N and property list uchar int vertex_indices; or a mesh exported as a surface"))
}

fn skip(body_reader: &mut BodyReader<'_>, element: &Element) -> Result<(), Diagnostic> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for _ in 0..element.count {
        for property in &element.properties {
            body_reader.skip(property)?;
        }
    }
    Ok(())
}

fn read_vertices(
    body_reader: &mut BodyReader<'_>,
    element: &Element,
    file: &Path,
    out: &mut Vec<Vec3>,
) -> Result<(), Diagnostic> {
    let mut axes = [usize::MAX; 3];
    for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
        let found = element.properties.iter().position(|p| p.name == name && p.list_count.is_none());
        *axis = found.ok_or_else(|| {
            Diagnostic::new(file, element.line, format!("the vertices have no {name}"))
                .hint(format!("property float {name}"))
        })?;
    }
    out.reserve(element.count);
    for _ in 0..element.count {
        let mut v = Vec3::ZERO.to_array();
        for (p, property) in element.properties.iter().enumerate() {
            match axes.iter().position(|&a| a == p) {
                Some(axis) => v[axis] = body_reader.scalar(property.kind)?,
                None => body_reader.skip(property)?,
            }
        }
        out.push(v.into());
    }
    Ok(())
}

/// Lists of corners, kept until all vertices are read, because faces may come first.
#[derive(Default)]
struct FaceLists {
    are_strips: bool,
    corners: Vec<f64>,
    ends: Vec<usize>,
}

impl FaceLists {
    fn read(&mut self, body_reader: &mut BodyReader<'_>, element: &Element) -> Result<(), Diagnostic> {
        let list = element
            .properties
            .iter()
            .position(|p| ["vertex_indices", "vertex_index"].contains(&p.name.as_str()) && p.list_count.is_some());
        let list = list.ok_or_else(|| {
            body_reader
                .error_at(element.line, format!("the element `{}` does not list its vertices", element.name))
                .hint("property list uchar int vertex_indices")
        })?;
        for _ in 0..element.count {
            for (p, property) in element.properties.iter().enumerate() {
                if p == list {
                    body_reader.list(property, &mut self.corners)?;
                    self.ends.push(self.corners.len());
                } else {
                    body_reader.skip(property)?;
                }
            }
        }
        Ok(())
    }

    fn triangulate(&self, mesh: &mut MeshData, file: &Path) -> Result<(), Diagnostic> {
        let mut polygon_corners = Vec::new();
        let mut begin = 0;
        for (i, &end) in self.ends.iter().enumerate() {
            polygon_corners.clear();
            for &corner in &self.corners[begin..end] {
                let exists = corner >= 0.0 && corner < mesh.vertices.len() as f64;
                if exists {
                    polygon_corners.push(corner as u32);
                } else if self.are_strips && corner == -1.0 {
                    polygon::strip(&polygon_corners, &mut mesh.triangles);
                    polygon_corners.clear();
                } else {
                    let what = format!(
                        "face {i} (from 0) has the corner {corner}, but there are {} vertices",
                        mesh.vertices.len()
                    );
                    return Err(Diagnostic::new(file, None, what).hint("numbers of vertices, counted from 0"));
                }
            }
            if self.are_strips {
                polygon::strip(&polygon_corners, &mut mesh.triangles);
            } else {
                polygon::triangulate(&mesh.vertices, &polygon_corners, &mut mesh.triangles);
            }
            begin = end;
        }
        Ok(())
    }
}
