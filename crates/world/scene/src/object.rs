//! An object of the scene.

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

/// A named shape that no joint moves.
#[derive(Debug, Clone)]
pub struct Object {
    /// Unique in the scene.
    pub name: String,
    /// Its collision shape.
    pub shape: Shape,
    /// Pose of the shape's frame in the world.
    pub in_world: Pose,
}
