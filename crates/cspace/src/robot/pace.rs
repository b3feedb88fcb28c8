//! How far a piece moves within a box of joint space.
//!
//! From the middle of the box to any point of it, at constant rates in a unit of time, a point x of the piece starts with the
//! velocity V = Σ δᵢ·vᵢ(x), where vᵢ(x) = aᵢ × (x − oᵢ) for a joint that turns, aᵢ for a slide. With x = c + r and
//! |r| ≤ R (the ball around the piece)
//!
//! |V|  ≤  |Σ δᵢ·vᵢ(c)| + R·|Σ δᵢ·aᵢ|,   |Σ δᵢ·uᵢ|²  ≤  Σ hᵢ²|uᵢ|² + 2 Σ_{i<j} hᵢ·hⱼ·|uᵢ·uⱼ|   for all |δᵢ| ≤ hᵢ.
//!
//! The velocity changes by no more than the growth Σⱼ (hⱼ + 2 Σ_{i<j} hᵢ)·hⱼ·Lⱼ in that time (derived in the scene's
//! `sweep/README.md`; Lⱼ bounds the distance from axis j), which adds half of it. No point moves farther than Σ hⱼ·Lⱼ, either.

use elbowroom_kinematics::ChainState;
use elbowroom_spatial::Vec3;

use super::joints::{Drive, MOST_JOINTS};
use super::part::Part;

/// How a piece moves with each axis of the map, at one configuration.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pace {
    /// Velocity of the ball's middle per unit of each axis.
    linear: [Vec3; MOST_JOINTS],
    /// The turn per unit of each axis.
    angular: [Vec3; MOST_JOINTS],
    pub center: Vec3,
    depth: usize,
}

/// Distances are trusted to this, metres: below it a gap counts as none.
const HAIR: f64 = 1e-9;

impl Pace {
    pub fn of(part: &Part, drive: &Drive, state: &ChainState) -> Self {
        let center = drive.link_in_world(state, part.link).transform_point(part.center);
        let mut pace =
            Self { linear: [Vec3::ZERO; MOST_JOINTS], angular: [Vec3::ZERO; MOST_JOINTS], center, depth: part.depth };
        for mover in &part.movers {
            let joint = drive.link_in_world(state, mover.child);
            let along = joint.transform_vector(mover.along) * mover.multiplier;
            if mover.turns {
                pace.linear[mover.axis] += along.cross(center - joint.translation);
                pace.angular[mover.axis] += along;
            } else {
                pace.linear[mover.axis] += along;
            }
        }
        pace
    }

    /// Farthest that any point of the piece moves within a box of these half widths, metres.
    pub fn farthest(&self, part: &Part, half: &[f64]) -> f64 {
        let (cap, growth) = limits(part, half);
        let at_once = largest(&self.linear, half, self.depth) + part.radius * largest(&self.angular, half, self.depth);
        cap.min(at_once + 0.5 * growth) * (1.0 + 1e-9) + HAIR
    }

    /// Farthest that a point of the piece (in the world) moves within a box of these half widths, metres.
    pub fn farthest_of(&self, part: &Part, half: &[f64], p: Vec3) -> f64 {
        let mut linear = self.linear;
        let by = p - self.center;
        for (v, w) in linear.iter_mut().zip(&self.angular).take(self.depth) {
            *v += w.cross(by);
        }
        let (cap, growth) = limits(part, half);
        cap.min(largest(&linear, half, self.depth) + 0.5 * growth) * (1.0 + 1e-9) + HAIR
    }

    /// How much an axis adds, metres, to first order.
    pub fn share(&self, part: &Part, axis: usize, half: &[f64]) -> f64 {
        half[axis] * (self.linear[axis].length() + part.radius * self.angular[axis].length())
    }

    /// Velocity, per unit of an axis, of a point of the piece (in the world).
    pub fn velocity(&self, axis: usize, p: Vec3) -> Vec3 {
        self.linear[axis] + self.angular[axis].cross(p - self.center)
    }
}

/// What no point of a piece moves farther than, and the growth.
fn limits(part: &Part, half: &[f64]) -> (f64, f64) {
    let (mut cap, mut growth, mut before) = (0.0, 0.0, 0.0);
    for (mover, lever) in part.movers.iter().zip(&part.levers) {
        let rate = half[mover.axis] * mover.multiplier.abs();
        if mover.turns {
            cap += rate * lever;
            growth += (rate + 2.0 * before) * rate * lever;
            before += rate;
        } else {
            cap += rate;
            growth += 2.0 * before * rate;
        }
    }
    (cap, growth)
}

/// Largest |Σ δᵢ·uᵢ| over all |δᵢ| ≤ hᵢ, from above.
fn largest(u: &[Vec3; MOST_JOINTS], half: &[f64], depth: usize) -> f64 {
    let mut sum = 0.0;
    for i in 0..depth {
        sum += half[i] * half[i] * u[i].length_squared();
        for j in 0..i {
            sum += 2.0 * half[i] * half[j] * u[i].dot(u[j]).abs();
        }
    }
    sum.sqrt()
}
