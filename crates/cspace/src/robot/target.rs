//! What stands around.

use elbowroom_proximity::{Shape, project_point};
use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::joints::RobotMapError;
use super::pieces;
use crate::Obstacle;

/// Something that the robot must not touch.
#[derive(Debug, Clone)]
pub(super) struct Target {
    pub shape: Shape,
    /// As it was given.
    original: Shape,
    pub in_world: Pose,
    pub bounds: Aabb,
    /// A point of each connected part of it; none where it has no end.
    pub points: Vec<Vec3>,
}

impl Target {
    pub fn new(shape: &Shape, in_world: &Pose) -> Result<Self, RobotMapError> {
        let refuse = || RobotMapError::Place("an obstacle".into());
        let far = |p: Vec3| !(p.abs().max_element() <= Obstacle::FARTHEST_M);
        if shape.validate().is_err() || !in_world.is_finite() || far(in_world.translation) {
            return Err(refuse());
        }
        let original = shape.clone();
        let shape = pieces::solid(shape);
        let bounds = shape.aabb(in_world);
        let endless = matches!(shape, Shape::HalfSpace(_));
        if !endless && (far(bounds.min) || far(bounds.max)) {
            return Err(refuse());
        }
        let points = match &shape {
            Shape::HalfSpace(_) => Vec::new(),
            Shape::Mesh(mesh) => mesh.parts().iter().map(|p| in_world.transform_point(*p)).collect(),
            _ => vec![in_world.translation],
        };
        Ok(Self { shape, original, in_world: *in_world, bounds, points })
    }

    /// No point of it is nearer to `p` than this, metres.
    pub fn at_least(&self, p: Vec3) -> f64 {
        match &self.shape {
            Shape::HalfSpace(_) => 0.0,
            Shape::Sphere(s) => (p.distance(self.in_world.translation) - s.radius).max(0.0),
            _ => {
                let nearest = p.clamp(self.bounds.min, self.bounds.max);
                p.distance(nearest)
            }
        }
    }

    /// How deep a point (in the world) is inside, metres; 0 or less outside.
    pub fn depth(&self, p: Vec3) -> f64 {
        depth_in(&self.original, &self.in_world, p)
    }

    /// True where something of it may be inside something of this radius: what is in one piece and larger cannot.
    pub fn fits_into(&self, radius: f64) -> bool {
        match self.points.len() {
            0 => false,
            1 => self.bounds.extent().max_element() <= 2.0 * radius * (1.0 + 1e-9),
            _ => true,
        }
    }
}

/// How deep a point (in the world) is inside a solid, metres; 0 or less outside.
pub(super) fn depth_in(shape: &Shape, in_world: &Pose, p: Vec3) -> f64 {
    -project_point(shape, in_world, p).signed_distance
}
