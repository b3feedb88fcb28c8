//! Scaled shapes.

use std::sync::Arc;

use elbowroom_proximity::{Capsule, ConvexHull, Cuboid, Cylinder, HullError, MeshError, Shape, Sphere, TriMesh};
use elbowroom_spatial::{Aabb, Vec3};

use crate::local_shape::LocalShape;

/// Why a shape cannot be scaled by this factor.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ScaleError {
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Hull(#[from] HullError),
}

/// The shape scaled by `factor` about the centre of its bounding box, in its own frame. Half-spaces stay as they are.
pub(crate) fn scaled(local: &LocalShape, factor: f64) -> Result<LocalShape, ScaleError> {
    let shape = match &local.shape {
        Shape::Sphere(s) => Shape::Sphere(Sphere { radius: s.radius * factor }),
        Shape::Capsule(c) => Shape::Capsule(Capsule { half_length: c.half_length * factor, radius: c.radius * factor }),
        Shape::Cylinder(c) => {
            Shape::Cylinder(Cylinder { half_length: c.half_length * factor, radius: c.radius * factor })
        }
        Shape::Cuboid(c) => Shape::Cuboid(Cuboid { half_extents: c.half_extents * factor }),
        Shape::HalfSpace(p) => Shape::HalfSpace(*p),
        Shape::Hull(h) => {
            Shape::Hull(Arc::new(ConvexHull::from_points(&scaled_about_center(h.vertices(), h.aabb(), factor))?))
        }
        Shape::Mesh(m) => {
            let vertices = scaled_about_center(m.vertices(), m.aabb(), factor);
            Shape::Mesh(Arc::new(TriMesh::new(vertices, m.triangles().to_vec())?))
        }
    };
    Ok(LocalShape::new(shape, local.in_geometry))
}

fn scaled_about_center(points: &[Vec3], bounds: &Aabb, factor: f64) -> Vec<Vec3> {
    let center = bounds.center();
    points.iter().map(|&p| center + (p - center) * factor).collect()
}
