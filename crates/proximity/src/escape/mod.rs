//! The way out of an overlap.

use elbowroom_spatial::{Pose, Vec3};

use crate::Shape;

/// A translation that ends an overlap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Escape {
    /// How far to move the first shape, metres.
    pub depth: f64,
    /// Which way to move it, unit vector in the world.
    pub direction: Vec3,
}

/// The shortest translation of `a` that separates it from `b`; `None` where they are apart.
pub fn escape(_a: &Shape, _a_in_world: &Pose, _b: &Shape, _b_in_world: &Pose) -> Option<Escape> {
    None
}
