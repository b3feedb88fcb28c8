//! Shapes and poses as messages, bit by bit.

use std::sync::Arc;

use elbowroom_proximity::{Capsule, ConvexHull, Cuboid, Cylinder, HalfSpace, Shape, Sphere, TriMesh};
use elbowroom_ros2::msgs::elbowroom_msgs::Solid;
use elbowroom_spatial::{Pose, Rotation, Vec3};

use crate::ConfigurationDefect;

/// Makes the message of a shape.
pub(crate) fn encode(shape: &Shape) -> Solid {
    match shape {
        Shape::Sphere(s) => Solid { kind: 1, radius: s.radius, ..Solid::default() },
        Shape::Capsule(s) => Solid { kind: 2, radius: s.radius, half_length: s.half_length, ..Solid::default() },
        Shape::Cylinder(s) => Solid { kind: 3, radius: s.radius, half_length: s.half_length, ..Solid::default() },
        Shape::Cuboid(s) => Solid { kind: 4, half_extents: s.half_extents.to_array(), ..Solid::default() },
        Shape::HalfSpace(_) => Solid { kind: 5, ..Solid::default() },
        Shape::Hull(hull) => with_faces(6, hull.vertices(), hull.triangles()),
        Shape::Mesh(mesh) => with_faces(7, mesh.vertices(), mesh.triangles()),
    }
}

fn with_faces(kind: u8, vertices: &[Vec3], triangles: &[[u32; 3]]) -> Solid {
    Solid {
        kind,
        vertices: vertices.iter().flat_map(|v| v.to_array()).collect(),
        triangles: triangles.iter().flatten().copied().collect(),
        ..Solid::default()
    }
}

/// Reads a shape from a message.
pub(crate) fn decode(solid: &Solid) -> Result<Shape, ConfigurationDefect> {
    let (radius, half_length) = (solid.radius, solid.half_length);
    Ok(match solid.kind {
        1 => Shape::Sphere(Sphere { radius }),
        2 => Shape::Capsule(Capsule { half_length, radius }),
        3 => Shape::Cylinder(Cylinder { half_length, radius }),
        4 => Shape::Cuboid(Cuboid { half_extents: solid.half_extents.into() }),
        5 => Shape::HalfSpace(HalfSpace),
        6 => Shape::Hull(Arc::new(faces(solid, ConvexHull::from_faces)?)),
        7 => Shape::Mesh(Arc::new(faces(solid, TriMesh::new)?)),
        number => return Err(ConfigurationDefect::Kind { what: "shape of kind", number }),
    })
}

fn faces<T, E: Into<ConfigurationDefect>>(
    solid: &Solid,
    build: impl FnOnce(Vec<Vec3>, Vec<[u32; 3]>) -> Result<T, E>,
) -> Result<T, ConfigurationDefect> {
    let (vertices, rest) = solid.vertices.as_chunks::<3>();
    let (triangles, more) = solid.triangles.as_chunks::<3>();
    if !(rest.is_empty() && more.is_empty()) {
        return Err(ConfigurationDefect::Faces);
    }
    build(vertices.iter().map(|v| (*v).into()).collect(), triangles.to_vec()).map_err(E::into)
}

/// Converts a pose to numbers, row by row.
pub(crate) fn pose_values(pose: &Pose) -> [f64; 12] {
    let mut values = [0.0; 12];
    let rows = pose.to_rows();
    values.iter_mut().zip(rows.iter().flatten()).for_each(|(to, value)| *to = *value);
    values
}

/// Converts twelve numbers to a pose; `None` if they are not a rotation. The numbers are not changed.
pub(crate) fn pose_of(values: &[f64; 12]) -> Option<Pose> {
    let column = |i: usize| Vec3::new(values[i], values[4 + i], values[8 + i]);
    Some(Pose::new(Rotation::from_columns(column(0), column(1), column(2))?, column(3)))
}
