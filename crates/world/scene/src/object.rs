//! An object of the scene.

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

/// A named shape that is not part of a robot.
#[derive(Debug, Clone)]
pub struct Object {
    /// Name, unique in the scene.
    pub name: String,
    /// Collision shape.
    pub shape: Shape,
    /// Pose of the shape's frame in the world.
    pub in_world: Pose,
}
