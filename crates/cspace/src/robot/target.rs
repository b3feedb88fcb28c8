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
    /// A point of it; `None` where it has no end.
    pub point: Option<Vec3>,
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
        let local = match &shape {
            Shape::HalfSpace(_) => None,
            Shape::Mesh(mesh) => mesh.vertices().first().copied(),
            _ => Some(Vec3::ZERO),
        };
        let point = local.map(|p| in_world.transform_point(p));
        Ok(Self { shape, original, in_world: *in_world, bounds, point })
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
        -project_point(&self.original, &self.in_world, p).signed_distance
    }

    /// Half its diagonal, metres: what is larger cannot be inside something of that size.
    pub fn size(&self) -> f64 {
        self.bounds.extent().length() * 0.5
    }
}
