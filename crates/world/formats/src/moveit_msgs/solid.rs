//! Shapes of an object: primitives, meshes, planes.

use std::path::Path;
use std::sync::Arc;

use elbowroom_proximity::{Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::field::{Field, Reading};
use super::pose;
use crate::mesh_data::UpAxis;
use crate::{Diagnostic, mesh as mesh_file, resolve};

/// Largest number of mesh files that one document may name.
const MAX_MESH_FILES: usize = 1000;

/// Treatment of a cone, for warnings.
pub(crate) const CONE: &str = "is a cone, which is enclosed by its cylinder";

/// Reads a box, sphere, cylinder or cone.
pub(crate) fn primitive(field: &Field<'_>, reading: &mut Reading) -> Result<Shape, Diagnostic> {
    let kind = field.require("type", "\"type\": \"box\", \"sphere\", \"cylinder\" or \"cone\"")?;
    let dimensions = field.require("dimensions", "\"dimensions\": the numbers of the shape, metres")?;
    if kind.is("box", 1) {
        let [x, y, z] = sizes(&dimensions, ["x", "y", "z"])?;
        return Ok(Shape::Cuboid(Cuboid { half_extents: Vec3::new(x, y, z) * 0.5 }));
    }
    if kind.is("sphere", 2) {
        let [radius] = sizes(&dimensions, ["radius"])?;
        return Ok(Shape::Sphere(Sphere { radius }));
    }
    let is_cone = kind.is("cone", 4);
    if is_cone || kind.is("cylinder", 3) {
        let [height, radius] = sizes(&dimensions, ["height", "radius"])?;
        if is_cone {
            let hint = "a mesh with \"vertices\" and \"triangles\" where the space beside the tip matters";
            reading.once("cone", field, CONE, hint);
        }
        return Ok(Shape::Cylinder(Cylinder { half_length: 0.5 * height, radius }));
    }
    Err(kind.error(format!("is {}, no known shape", kind.shown()), "\"box\", \"sphere\", \"cylinder\" or \"cone\""))
}

/// True for a valid dimension of a solid, metres.
pub(crate) fn is_size(v: f64) -> bool {
    (0.0..=1e9).contains(&v)
}

/// Reads a fixed number of non-negative dimensions.
fn sizes<const N: usize>(field: &Field<'_>, names: [&str; N]) -> Result<[f64; N], Diagnostic> {
    let sizes = field.tuple(names)?;
    match sizes.iter().position(|v| !is_size(*v)) {
        Some(i) => Err(field.error(format!("has {} as {}", sizes[i], names[i]), "metres, 0 or more")),
        None => Ok(sizes),
    }
}

/// Reads a mesh from its vertices and triangles, or from its file.
pub(crate) fn mesh(field: &Field<'_>, reading: &mut Reading) -> Result<Shape, Diagnostic> {
    let layout = "\"vertices\": [[x, y, z], …], \"triangles\": [[0, 1, 2], …]";
    if let (None, Some(resource)) = (field.get("vertices")?, field.get("resource")?) {
        let scale = field.get("dimensions")?.map_or(Ok([1.0; 3]), |d| d.tuple(["x", "y", "z"]))?;
        return mesh_file(&resource, scale, reading).map(Shape::Mesh);
    }
    let vertices = field.require("vertices", layout)?.elements()?;
    let triangles = field.require("triangles", layout)?.elements()?;
    let vertices = vertices.iter().map(pose::point).collect::<Result<Vec<_>, _>>()?;
    let triangles = triangles.iter().map(triangle).collect::<Result<Vec<_>, _>>()?;
    let mesh = TriMesh::new(vertices, triangles).map_err(|e| field.error(format!("is no mesh: {e}"), layout))?;
    Ok(Shape::Mesh(Arc::new(mesh)))
}

/// Reads the mesh of a file, in metres. The file is found as in a URDF.
fn mesh_file(resource: &Field<'_>, scale: [f64; 3], reading: &mut Reading) -> Result<Arc<TriMesh>, Diagnostic> {
    let name = resource.text()?;
    let key = (name.to_owned(), scale.map(f64::to_bits));
    if let Some(mesh) = reading.mesh_files.get(&key) {
        return Ok(Arc::clone(mesh));
    }
    if reading.mesh_files.len() == MAX_MESH_FILES {
        return Err(resource.error(format!("is the mesh file number {}", MAX_MESH_FILES + 1), "fewer mesh files"));
    }
    let folder = resource.location.file.parent().unwrap_or(Path::new(""));
    let path = resolve::resolve(name, folder).map_err(|why| {
        let hint = "a path relative to this file, package://PACKAGE/PATH, or \"vertices\" and \"triangles\" instead";
        resource.error(format!("names a mesh file that is not found: {why}"), hint)
    })?;
    let mut mesh = mesh_file::load_with(&path, None, UpAxis::Ignore)?.merged();
    mesh.scale(Vec3::from(scale));
    let size = mesh.aabb();
    if !pose::is_position(size.min) || !pose::is_position(size.max) {
        return Err(resource.error("is a mesh with a coordinate above 1e9 m", "a mesh in metres"));
    }
    let mesh = Arc::new(mesh.into_trimesh(&path)?);
    reading.mesh_files.insert(key, Arc::clone(&mesh));
    Ok(mesh)
}

fn triangle(field: &Field<'_>) -> Result<[u32; 3], Diagnostic> {
    let hint = "three indices of vertices: [0, 1, 2]";
    let corners =
        if field.is_list() { field.elements()? } else { field.require("vertex_indices", hint)?.elements()? };
    let corners = corners.iter().map(Field::index).collect::<Result<Vec<_>, _>>()?;
    <[u32; 3]>::try_from(corners).map_err(|c| field.error(format!("has {} corners, not 3", c.len()), hint))
}

/// Reads a plane from its coefficients.
pub(crate) fn plane(field: &Field<'_>) -> Result<(Shape, Pose), Diagnostic> {
    let coefficients = if field.is_list() { None } else { field.get("coef")? };
    let [a, b, c, d] = coefficients.as_ref().unwrap_or(field).tuple(["a", "b", "c", "d"])?;
    let hint = "a, b, c, d of a x + b y + c z + d = 0: [0, 0, 1, 0]";
    half_space([a, b, c, d]).ok_or_else(|| field.error("is a plane without a direction", hint))
}

/// The half-space below the plane `a x + b y + c z + d = 0`, and its pose; `None` if the plane has no direction.
pub(crate) fn half_space([a, b, c, d]: [f64; 4]) -> Option<(Shape, Pose)> {
    let length = (a * a + b * b + c * c).sqrt();
    let normal = Vec3::new(a, b, c).try_normalize().filter(|n| n.is_finite())?;
    let origin = normal * (-d / length);
    origin.is_finite().then(|| (Shape::HalfSpace(HalfSpace), Pose::new(Rotation::from_z(normal), origin)))
}
