//! A shape in the frame of its link or object.

use elbowroom_proximity::Shape;
use elbowroom_spatial::{Aabb, Pose};

/// A shape in the frame of its link or object.
#[derive(Debug, Clone)]
pub(crate) struct LocalShape {
    pub shape: Shape,
    /// Pose of the shape's frame in the frame of its link or object.
    pub in_geometry: Pose,
    /// Bounding box in the frame of the link or object. Used for geometry of several shapes.
    pub bounds: Aabb,
}

impl LocalShape {
    pub fn new(shape: Shape, in_geometry: Pose) -> Self {
        let bounds = shape.aabb(&in_geometry);
        Self { shape, in_geometry, bounds }
    }
}
