//! Blends: corners that the motion passes without a stop.
//!
//! The velocity changes smoothly from the velocity on one segment to that on the next, `v1 + (v2 − v1)·S(t/T)` with `S
//! = 3τ² − 2τ³`. Therefore no joint is faster than on the segments, accelerations are at most 1.5·|v2 − v1|/T and 0 at
//! the ends, and jerks are at most 6·|v2 − v1|/T². As `S` is below its mirror image in the first half, the curve stays
//! in the triangle of its ends and the corner.

use elbowroom_kinematics::JointLimits;

/// A blended corner: unit directions of both segments, and the speed along each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blend<'l> {
    pub before: &'l [f64],
    pub after: &'l [f64],
    pub speed: f64,
    pub seconds: f64,
}

impl Blend<'_> {
    /// Duration at a speed along both segments (unit directions), s.
    pub fn seconds(speed: f64, [u, v]: [&[f64]; 2], limits: &[JointLimits]) -> f64 {
        let changes = u.iter().zip(v).map(|(u, v)| speed * (v - u).abs());
        let each = changes.zip(limits);
        let seconds =
            |(change, l): (f64, &JointLimits)| (1.5 * change / l.acceleration).max((6.0 * change / l.jerk).sqrt());
        each.map(seconds).fold(0.0, f64::max)
    }

    /// Position (relative to the beginning of the blend), velocity and acceleration of one joint after `t` seconds.
    pub fn at(&self, t: f64, joint: usize) -> [f64; 3] {
        let x = (t / self.seconds).clamp(0.0, 1.0);
        let share = x * x * (3.0 - 2.0 * x);
        let after = self.seconds * x * x * x * (1.0 - 0.5 * x);
        let before = self.seconds * x - after;
        let steep = 6.0 * x * (1.0 - x) / self.seconds;
        let (u, v) = (self.speed * self.before[joint], self.speed * self.after[joint]);
        [u * before + v * after, u + (v - u) * share, (v - u) * steep]
    }
}
