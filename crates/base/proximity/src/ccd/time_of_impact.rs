//! The result of continuous collision detection.

use elbowroom_spatial::Vec3;

/// The first contact of two moving shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeOfImpact {
    /// Fraction of the motion in `[0, 1]` before which the shapes do not touch; 0 if they touch at the start.
    pub time: f64,
    /// Nearest point of the first shape at that time, in the world.
    pub on_a: Vec3,
    /// Nearest point of the second shape at that time, in the world.
    pub on_b: Vec3,
    /// Unit vector from the second shape to the first; `None` if the distance is 0. Then the shapes overlap, which is
    /// possible only at the start, or are too close for f64 to separate.
    pub normal: Option<Vec3>,
    /// Distance at that time, metres; at most the tolerance if the contact is certain.
    pub separation: f64,
    /// Number of distance queries.
    pub steps: u32,
    /// False if the proof ended here without a contact: the steps were used up, a number is not finite, or a speed bound
    /// is infinite. The motion is free before `time` and unknown after it.
    pub certain: bool,
}

impl TimeOfImpact {
    /// True if the shapes were within the tolerance from the start.
    pub fn at_start(&self) -> bool {
        self.time == 0.0
    }
}
