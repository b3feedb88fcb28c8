//! Shapes of an object: primitives, meshes, planes.

use std::sync::Arc;

use elbowroom_proximity::{Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh};
use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::field::{Field, Notes};
use super::pose;
use crate::FormatError;

/// A box, sphere, cylinder or cone.
pub(super) fn primitive(field: &Field<'_>, notes: &mut Notes) -> Result<Shape, FormatError> {
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
            notes.once("cone", field, "is a cone, which is enclosed by its cylinder", hint);
        }
        return Ok(Shape::Cylinder(Cylinder { half_length: 0.5 * height, radius }));
    }
    Err(kind.error(format!("is {}, no known shape", kind.shown()), "\"box\", \"sphere\", \"cylinder\" or \"cone\""))
}

/// So many dimensions, none negative.
fn sizes<const N: usize>(field: &Field<'_>, names: [&str; N]) -> Result<[f64; N], FormatError> {
    let sizes = field.tuple(names)?;
    let is_size = |v: &f64| (0.0..=1e9).contains(v);
    match sizes.iter().position(|v| !is_size(v)) {
        Some(i) => Err(field.error(format!("has {} as {}", sizes[i], names[i]), "metres, 0 or more")),
        None => Ok(sizes),
    }
}

/// A mesh with its vertices and triangles.
pub(super) fn mesh(field: &Field<'_>) -> Result<Shape, FormatError> {
    let layout = "\"vertices\": [[x, y, z], …], \"triangles\": [[0, 1, 2], …]";
    if field.get("vertices")?.is_none() && field.get("resource")?.is_some() {
        return Err(field.error("names a mesh file, which is not read", layout));
    }
    let vertices = field.require("vertices", layout)?.elements()?;
    let triangles = field.require("triangles", layout)?.elements()?;
    let vertices = vertices.iter().map(pose::point).collect::<Result<Vec<_>, _>>()?;
    let triangles = triangles.iter().map(triangle).collect::<Result<Vec<_>, _>>()?;
    let mesh = TriMesh::new(vertices, triangles).map_err(|e| field.error(format!("is no mesh: {e}"), layout))?;
    Ok(Shape::Mesh(Arc::new(mesh)))
}

fn triangle(field: &Field<'_>) -> Result<[u32; 3], FormatError> {
    let hint = "three indices of vertices: [0, 1, 2]";
    let corners = match field.elements() {
        Ok(corners) => corners,
        Err(_) => field.require("vertex_indices", hint)?.elements()?,
    };
    let corners = corners.iter().map(Field::index).collect::<Result<Vec<_>, _>>()?;
    <[u32; 3]>::try_from(corners).map_err(|c| field.error(format!("has {} corners, not 3", c.len()), hint))
}

/// A plane `a x + b y + c z + d = 0` as the half-space below it, and its pose.
pub(super) fn plane(field: &Field<'_>) -> Result<(Shape, Pose), FormatError> {
    let [a, b, c, d] = match field.get("coef") {
        Ok(Some(coefficients)) => coefficients.tuple(["a", "b", "c", "d"])?,
        _ => field.tuple(["a", "b", "c", "d"])?,
    };
    let length = (a * a + b * b + c * c).sqrt();
    let normal = Vec3::new(a, b, c).try_normalize().filter(|n| n.is_finite());
    match normal.map(|n| (n, n * (-d / length))) {
        Some((normal, origin)) if origin.is_finite() => {
            Ok((Shape::HalfSpace(HalfSpace), Pose::new(Rotation::from_z(normal), origin)))
        }
        _ => Err(field.error("is a plane without a direction", "a, b, c, d of a x + b y + c z + d = 0: [0, 0, 1, 0]")),
    }
}
