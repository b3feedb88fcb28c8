//! Simple shapes around points, always enclosing every one of them.

use elbowroom_spatial::{Pose, Vec3};

use crate::Shape;

/// A shape that encloses given points.
#[derive(Debug, Clone)]
pub struct Fit {
    /// Capsule, cuboid or sphere.
    pub shape: Shape,
    /// Its frame in the frame of the points.
    pub in_frame: Pose,
    /// Its volume, m³.
    pub volume: f64,
}

/// A small enclosing capsule; `None` without points or where one is not finite.
pub fn capsule(_points: &[Vec3]) -> Option<Fit> {
    None
}
/// A small enclosing box; `None` without points or where one is not finite.
pub fn cuboid(_points: &[Vec3]) -> Option<Fit> {
    None
}
/// The smallest enclosing sphere; `None` without points or where one is not finite.
pub fn sphere(_points: &[Vec3]) -> Option<Fit> {
    None
}
/// The smaller of capsule and box by volume; `None` without points or where one is not finite.
pub fn tightest(_points: &[Vec3]) -> Option<Fit> {
    None
}
