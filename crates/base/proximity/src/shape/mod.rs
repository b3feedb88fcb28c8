//! The shapes.

mod any_shape;
mod capsule;
mod cuboid;
mod cylinder;
mod half_space;
pub(crate) mod hull;
mod hull_error;
mod mesh_report;
mod point_in_mesh;
mod quickhull;
mod sphere;
pub(crate) mod topology;
mod tri_mesh;
mod validity;

pub use any_shape::{Shape, ShapeError, ShapeKind};
pub use capsule::Capsule;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use half_space::HalfSpace;
pub use hull::ConvexHull;
pub use hull_error::HullError;
pub use mesh_report::MeshReport;
pub use sphere::Sphere;
pub use tri_mesh::{MeshError, TriMesh};
pub(crate) use validity::is_usable_pose;
