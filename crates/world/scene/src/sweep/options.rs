//! Settings and result of a sweep.

use elbowroom_robot::GeometryId;
use elbowroom_spatial::Vec3;

use crate::Level;

/// Settings of a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SweepOptions {
    /// Clearance, metres.
    ///
    /// A pair is hit when it is nearer than its margin plus this. Values below 0 count as 0, NaN as infinite.
    pub clearance_m: f64,
    /// Resolution of a hit, metres.
    ///
    /// Before a reported hit, every pair was farther apart than its margin plus the clearance. At the hit, one pair is at
    /// most its margin plus the clearance plus the tolerance apart. A pass in between may or may not be reported. The
    /// resolution is never finer than the rounding of poses of that size (about 1e-14 of the largest coordinate). 0,
    /// negative numbers and NaN select that finest resolution.
    pub tolerance_m: f64,
    /// Leaves out pairs that do not move relative to each other: what rests in contact is not reported then.
    pub moving_only: bool,
    /// Largest number of distances of exact shapes. Beyond it, the answer is a hit that is not [`SweepHit::certain`].
    pub max_steps: u32,
}

impl Default for SweepOptions {
    /// Contact (no clearance) to 0.1 mm, all pairs, 20,000 distances.
    fn default() -> Self {
        Self { clearance_m: 0.0, tolerance_m: 1e-4, moving_only: false, max_steps: 20_000 }
    }
}

/// The first time at which a pair is too near during a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SweepHit {
    /// Time as a fraction of the motion in `[0, 1]`: before it, no pair was too near.
    ///
    /// 0 if a pair is too near at the start.
    pub time: f64,
    /// First geometry of the pair, in the order of the allowed collision matrix.
    pub a: GeometryId,
    /// Second geometry of the pair.
    pub b: GeometryId,
    /// Witness point on `a` (without padding) at that time, in the world.
    pub on_a: Vec3,
    /// Witness point on `b` (without padding) at that time, in the world.
    pub on_b: Vec3,
    /// Distance between the shapes at that time, less the pair's margin, metres; 0 on contact.
    pub metres: f64,
    /// The level of the models that were measured.
    pub level: Level,
    /// Number of distances measured, over all pairs and times.
    pub steps: u32,
    /// False if the proof ended without a contact: steps used up, a number that is not finite, an infinite speed bound.
    ///
    /// The motion is then free before `time` and unknown after it. Unknown does not mean free.
    pub certain: bool,
}

impl SweepHit {
    /// True if the pair was too near from the start.
    pub fn at_start(&self) -> bool {
        self.time == 0.0
    }
}
