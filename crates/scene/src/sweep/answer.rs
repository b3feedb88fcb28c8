//! How closely a sweep looks, and what it answers.

use elbowroom_spatial::Vec3;

use crate::{Level, Member};

/// How closely a sweep looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SweepOptions {
    /// A pair counts as soon as it is nearer than this beyond its margin, metres. Less than 0 counts as 0, NaN as
    /// infinite.
    pub clearance_m: f64,
    /// How finely "nearer" is told, metres: before a reported impact every pair was farther than its margin and the
    /// clearance, at it one is no farther than that and the tolerance. A pass in between may or may not be reported.
    /// Not finer than what poses of that size can tell apart (about 1e-14 of the largest coordinate); 0, a negative
    /// number or NaN ask for just that.
    pub tolerance_m: f64,
    /// After so many distances of exact solids the answer is an impact that is not [`Impact::certain`].
    pub max_steps: u32,
}

impl Default for SweepOptions {
    /// Contact (no clearance) to 0.1 mm, 20,000 distances.
    fn default() -> Self {
        Self { clearance_m: 0.0, tolerance_m: 1e-4, max_steps: 20_000 }
    }
}

/// The first time that a pair is too near during a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact {
    /// When, as a fraction of the motion in `[0, 1]`: no pair was too near before. 0 where one is at the start.
    pub time: f64,
    /// The first of the pair, in the order of the pair matrix.
    pub a: Member,
    /// The other.
    pub b: Member,
    /// Nearest point on the solid of `a` (without padding) at that time, in the world.
    pub on_a: Vec3,
    /// Nearest point on the solid of `b`.
    pub on_b: Vec3,
    /// Metres between the solids at that time, less the pair's margin; 0 on contact.
    pub metres: f64,
    /// The level that was measured.
    pub level: Level,
    /// How often the distance of a pair was measured, all pairs and instants together.
    pub steps: u32,
    /// False where the proof ended here without a contact: steps used up, a number that is not finite, a bound of
    /// speed that is infinite. It is free before `time` and unknown after, and unknown is not free.
    pub certain: bool,
}

impl Impact {
    /// True where the pair was too near from the start.
    pub fn at_start(&self) -> bool {
        self.time == 0.0
    }
}
