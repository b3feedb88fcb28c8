//! A point of a surface with its normal.

use elbowroom_spatial::Vec3;

/// A point of a surface and its normal, in the root link's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrientedPoint {
    /// The point, m.
    pub point_in_root: Vec3,
    /// Outward normal of the surface, unit length. `None` if it is unknown or, in a target, if it does not matter.
    pub normal_in_root: Option<Vec3>,
}
