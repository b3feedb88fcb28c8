//! A solid thing of the cell.

use elbowroom_proximity::Shape;
use elbowroom_spatial::Pose;

/// A named solid that no joint moves.
#[derive(Debug, Clone)]
pub struct Object {
    /// Unique in the cell.
    pub name: String,
    /// Its solid.
    pub shape: Shape,
    /// Where the shape's frame stands.
    pub in_world: Pose,
}
