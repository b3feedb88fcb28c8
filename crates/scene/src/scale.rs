//! Larger and smaller solids.

use std::sync::Arc;

use elbowroom_proximity::{Capsule, ConvexHull, Cuboid, Cylinder, HullError, MeshError, Shape, Sphere, TriMesh};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use crate::model::Solid;

/// Why a shape cannot be scaled by this factor.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ScaleError {
    #[error(transparent)]
    Mesh(#[from] MeshError),
    #[error(transparent)]
    Hull(#[from] HullError),
}

/// The solid `factor` times as large, about the centre of its bounds in its own frame.
pub(crate) fn scaled(solid: &Solid, factor: f64) -> Result<Solid, ScaleError> {
    let shape = match &solid.shape {
        Shape::Sphere(s) => Shape::Sphere(Sphere { radius: s.radius * factor }),
        Shape::Capsule(c) => Shape::Capsule(Capsule { half_length: c.half_length * factor, radius: c.radius * factor }),
        Shape::Cylinder(c) => {
            Shape::Cylinder(Cylinder { half_length: c.half_length * factor, radius: c.radius * factor })
        }
        Shape::Cuboid(c) => Shape::Cuboid(Cuboid { half_extents: c.half_extents * factor }),
        Shape::HalfSpace(p) => Shape::HalfSpace(*p),
        Shape::Hull(h) => Shape::Hull(Arc::new(ConvexHull::from_points(&about(h.vertices(), h.aabb(), factor))?)),
        Shape::Mesh(m) => {
            let vertices = about(m.vertices(), m.aabb(), factor);
            Shape::Mesh(Arc::new(TriMesh::new(vertices, m.triangles().to_vec())?))
        }
    };
    Ok(Solid::new(shape, Pose { ..solid.in_member }))
}

fn about(points: &[Vec3], bounds: &Aabb, factor: f64) -> Vec<Vec3> {
    let center = bounds.center();
    points.iter().map(|&p| center + (p - center) * factor).collect()
}
