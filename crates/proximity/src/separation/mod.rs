//! Distance between two placed shapes.

use elbowroom_spatial::{Pose, Vec3};

use crate::Shape;

/// How far apart two shapes are, and where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Distance in metres, 0 on contact or overlap.
    pub distance: f64,
    /// Proven: the exact distance is not below this, metres.
    pub lower_bound: f64,
    /// Nearest point of the first shape, in the world. On overlap: some common or nearby point.
    pub on_a: Vec3,
    /// Nearest point of the second shape, in the world.
    pub on_b: Vec3,
}

/// Distance between two shapes, with witness points.
pub fn separation(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> Separation {
    separation_within(a, a_in_world, b, b_in_world, f64::INFINITY).unwrap_or(Separation {
        distance: 0.0,
        lower_bound: 0.0,
        on_a: a_in_world.translation,
        on_b: b_in_world.translation,
    })
}

/// Like [`separation`], or `None` where the shapes are certainly farther apart than `limit` metres.
pub fn separation_within(
    _a: &Shape,
    _a_in_world: &Pose,
    _b: &Shape,
    _b_in_world: &Pose,
    _limit: f64,
) -> Option<Separation> {
    None
}

/// True where the shapes touch or overlap.
pub fn collides(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose) -> bool {
    within(a, a_in_world, b, b_in_world, 0.0)
}

/// True where the shapes are not farther apart than `tolerance` metres.
pub fn within(a: &Shape, a_in_world: &Pose, b: &Shape, b_in_world: &Pose, tolerance: f64) -> bool {
    separation(a, a_in_world, b, b_in_world).lower_bound <= tolerance
}
