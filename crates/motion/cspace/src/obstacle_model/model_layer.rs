//! Layers of obstacle models.

use elbowroom_spatial::Pose;

use super::model::ObstacleModel;
use super::planar_slice;
use super::sphere_set::spheres_until;
use crate::convex_obstacle::ConvexShape;
use crate::{ConvexObstacle, Layer, PlanarMapBuilder};

impl ObstacleModel {
    /// Replaces a layer by the cells that this model of an obstacle blocks; the model always blocks all cells that the
    /// obstacle itself blocks.
    pub fn build_layer(self, builder: &mut PlanarMapBuilder, obstacle: &ConvexObstacle, layer: &mut Layer) {
        match self {
            Self::Exact => builder.build_layer(obstacle, layer),
            Self::Slices => planar_slice::build_layer(builder, obstacle, layer),
            Self::Sphere => {
                let (center, radius) = obstacle.enclosing_sphere();
                builder.build_layer(&ConvexObstacle { solid: ConvexShape::Sphere { center, radius } }, layer);
            }
            Self::Spheres(count) => {
                spheres_until(builder, obstacle, count, None, layer);
            }
            Self::Box => {
                let bounds = obstacle.bounds();
                let in_base = Pose::from_translation((bounds.min + bounds.max) * 0.5);
                let half_extents = (bounds.max - bounds.min) * 0.5;
                builder.build_layer(&ConvexObstacle { solid: ConvexShape::Cuboid { in_base, half_extents } }, layer);
            }
        }
    }
}
