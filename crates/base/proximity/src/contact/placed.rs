//! Two placed shapes.

use elbowroom_spatial::Pose;

use crate::Shape;

/// A shape and its pose.
#[derive(Clone, Copy)]
pub(super) struct PlacedShape<'a> {
    pub shape: &'a Shape,
    pub in_world: &'a Pose,
}
