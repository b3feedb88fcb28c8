//! The result of a distance query: separation distance, lower bound, witness points.

use elbowroom_spatial::{Pose, Vec3};

/// The separation of two shapes: distance, a proven lower bound, and witness points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    /// Distance in metres. It is 0 on contact or overlap, and if f64 cannot separate these from a gap. It is 0 exactly
    /// if `lower_bound` is 0, and exactly if [`collides`](crate::collides()) is true.
    pub distance: f64,
    /// Proven lower bound of the exact distance, metres. For closed forms it is `distance` minus a few units in the last
    /// place of the largest coordinate involved.
    pub lower_bound: f64,
    /// Witness point: the nearest point of the first shape, in the world. On contact it is a point in both shapes, or
    /// within rounding of both; if one mesh is inside another, a point of the inner mesh.
    pub on_a: Vec3,
    /// Witness point of the second shape, in the world. It is `distance` from `on_a`, to within 1e-15 of the largest
    /// coordinate involved. On contact: `on_a`.
    ///
    /// If the witness points are not unique, see [`WitnessPoints`](crate::WitnessPoints).
    pub on_b: Vec3,
}

impl Separation {
    /// The result with the shapes exchanged.
    pub(super) fn swapped(self) -> Self {
        Self { on_a: self.on_b, on_b: self.on_a, ..self }
    }

    /// The result for shapes or poses that are not usable: in contact, at the origins.
    pub(crate) fn unknown(a_in_world: &Pose, b_in_world: &Pose) -> Self {
        Self { distance: 0.0, lower_bound: 0.0, on_a: a_in_world.translation, on_b: b_in_world.translation }
    }
}
