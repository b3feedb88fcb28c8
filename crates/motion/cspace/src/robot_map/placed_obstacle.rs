//! Obstacles in the world.

use elbowroom_proximity::{Shape, project_point};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::error::RobotMapError;
use super::solid_pieces::as_mesh;
use crate::ConvexObstacle;

/// An obstacle, placed in the world.
#[derive(Debug, Clone)]
pub(super) struct PlacedObstacle {
    /// The shape, converted by [`as_mesh`].
    pub shape: Shape,
    /// The shape as given.
    original: Shape,
    pub in_world: Pose,
    pub bounds: Aabb,
    /// One point of each connected component; empty for a half space.
    pub points: Vec<Vec3>,
}

impl PlacedObstacle {
    pub fn new(shape: &Shape, in_world: &Pose) -> Result<Self, RobotMapError> {
        let invalid = || RobotMapError::InvalidPlacement("an obstacle".into());
        let far = |p: Vec3| !(p.abs().max_element() <= ConvexObstacle::MAX_COORDINATE_M);
        if shape.validate().is_err() || !in_world.is_finite() || far(in_world.translation) {
            return Err(invalid());
        }
        let original = shape.clone();
        let shape = as_mesh(shape);
        let bounds = shape.aabb(in_world);
        let is_unbounded = matches!(shape, Shape::HalfSpace(_));
        if !is_unbounded && (far(bounds.min) || far(bounds.max)) {
            return Err(invalid());
        }
        let points = match &shape {
            Shape::HalfSpace(_) => Vec::new(),
            Shape::Mesh(mesh) => mesh.component_vertices().iter().map(|p| in_world.transform_point(*p)).collect(),
            _ => vec![in_world.translation],
        };
        Ok(Self { shape, original, in_world: *in_world, bounds, points })
    }

    /// Lower bound of the distance from `p`, metres.
    pub fn min_distance(&self, p: Vec3) -> f64 {
        match &self.shape {
            Shape::HalfSpace(_) => 0.0,
            Shape::Sphere(s) => (p.distance(self.in_world.translation) - s.radius).max(0.0),
            _ => {
                let nearest = p.clamp(self.bounds.min, self.bounds.max);
                p.distance(nearest)
            }
        }
    }

    /// Depth of a point (in the world) below the surface, metres; 0 or less outside.
    pub fn depth_of(&self, p: Vec3) -> f64 {
        depth_inside(&self.original, &self.in_world, p)
    }

    /// Whether a component of the obstacle may fit inside a ball of this radius.
    pub fn fits_inside(&self, radius: f64) -> bool {
        match self.points.len() {
            0 => false,
            1 => self.bounds.extent().max_element() <= 2.0 * radius * (1.0 + 1e-9),
            _ => true,
        }
    }
}

/// Depth of a point (in the world) below the surface of a solid, metres; 0 or less outside.
pub(super) fn depth_inside(shape: &Shape, in_world: &Pose, p: Vec3) -> f64 {
    -project_point(shape, in_world, p).signed_distance
}
