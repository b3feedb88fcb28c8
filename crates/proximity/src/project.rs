//! The nearest point of a surface.

use elbowroom_spatial::{Pose, Vec3};

use crate::Shape;

/// The point of a shape's surface nearest to a given point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Distance to the surface in metres, negative inside the solid.
    pub signed_distance: f64,
    /// Nearest point of the surface, in the frame of the question.
    pub on_surface: Vec3,
    /// Unit vector along which the signed distance grows fastest: the outward normal there.
    pub outward: Vec3,
}

/// Nearest surface point and signed distance of the world point `p`.
pub fn project_point(_shape: &Shape, shape_in_world: &Pose, _p: Vec3) -> SurfacePoint {
    SurfacePoint { signed_distance: 0.0, on_surface: shape_in_world.translation, outward: Vec3::Z }
}
