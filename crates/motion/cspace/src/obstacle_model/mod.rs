//! The obstacle models of the joint-space paper: conservative simplifications of an obstacle.

mod model;
mod model_layer;
mod planar_slice;
mod sphere_set;

pub(crate) use model::MAX_SPHERES;
pub use model::{ObstacleModel, UnknownObstacleModel};
pub use sphere_set::spheres_until;
