//! Lever arms: how far the points of a body can be from the axes of the joints that move it.
//!
//! The body is enclosed in a cylinder about the axis of its own joint. Turning it about that axis leaves the cylinder as it is,
//! sliding it along the axis makes it longer. Seen from the joint before, the cylinder is enclosed in one about that joint's
//! axis, and so on to the base: the radii are the lever arms, whatever the values of the joints.

use elbowroom_spatial::{Pose, Vec3};

use super::forward::BatchedChain;
use crate::cover::Ball;

/// Points of a circle that are measured; the largest distance lies between two of them.
const CIRCLE_POINTS: u32 = 64;

/// A cylinder about the z axis of a joint's frame.
#[derive(Debug, Clone, Copy)]
struct AxisCylinder {
    radius: f64,
    low: f64,
    high: f64,
}

impl AxisCylinder {
    fn around(balls: impl Iterator<Item = Ball>) -> Self {
        let none = Self { radius: 0.0, low: f64::INFINITY, high: f64::NEG_INFINITY };
        balls.fold(none, |c, b| Self {
            radius: c.radius.max(b.centre.x.hypot(b.centre.y) + b.radius),
            low: c.low.min(b.centre.z - b.radius),
            high: c.high.max(b.centre.z + b.radius),
        })
    }

    /// Around all positions of a slide along the axis.
    fn slid(self, lower: f64, upper: f64) -> Self {
        Self { low: self.low + lower.min(0.0), high: self.high + upper.max(0.0), ..self }
    }

    /// A cylinder about another z axis, in whose frame this one's is at a pose.
    fn seen_from(self, pose: &Pose) -> Self {
        let axis = pose.rotation.z_axis();
        let ends = [self.low, self.high].map(|z| pose.translation + axis * z);
        let along = self.radius * (1.0 - axis.z * axis.z).max(0.0).sqrt();
        let radius = ends.into_iter().map(|end| self.farthest_from_axis(pose, end)).fold(0.0, f64::max);
        let (low, high) = (ends[0].z.min(ends[1].z) - along, ends[0].z.max(ends[1].z) + along);
        Self { radius, low, high }
    }

    /// Largest distance of a circle about this axis from the other axis.
    fn farthest_from_axis(self, pose: &Pose, centre: Vec3) -> f64 {
        let (x, y) = (pose.rotation.x_axis() * self.radius, pose.rotation.y_axis() * self.radius);
        let step = std::f64::consts::TAU / f64::from(CIRCLE_POINTS);
        let distance = |i: u32| {
            let (sin, cos) = (f64::from(i) * step).sin_cos();
            let p = centre + x * cos + y * sin;
            p.x.hypot(p.y)
        };
        // Between two points the circle is nowhere farther from their chord than this.
        let between = self.radius * (1.0 - (0.5 * step).cos());
        (0..CIRCLE_POINTS).map(distance).fold(0.0, f64::max) + between
    }
}

/// What the rounding errors of a body's points grow with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reach {
    /// Number of joints that move the body.
    pub joints: usize,
    /// Sum over these joints: how far a point of the body can be from the joint's origin, m.
    pub arms_m: f64,
    /// How far a point of the body, or an origin on the path to it, can be from the origin of the world, m.
    pub world_m: f64,
}

impl Reach {
    /// Of a body whose points are within `radius_m` of the origin of its joint's frame.
    pub fn new(chain: &BatchedChain, frame: usize, radius_m: f64) -> Self {
        let steps = chain.steps_to(frame);
        let (mut arm_m, mut arms_m) = (radius_m, 0.0);
        for &i in steps.iter().rev() {
            let step = &chain.steps[i];
            if step.is_prismatic {
                arm_m += step.lower.abs().max(step.upper.abs());
            }
            arms_m += arm_m;
            arm_m += step.at_zero.translation.length();
        }
        Self { joints: steps.len(), arms_m, world_m: arm_m + chain.base_in_world.translation.length() }
    }
}

/// Per step of the chain: the largest distance of a point of the body from the axis of a turning joint, 1 for a slide, 0 for a
/// joint that does not move the body. The balls are given in the frame of the body's joint.
pub(super) fn lever_arms(chain: &BatchedChain, frame: usize, balls: impl Iterator<Item = Ball>) -> Vec<f64> {
    let mut levers = vec![0.0; chain.steps.len()];
    let mut cylinder = AxisCylinder::around(balls);
    for &i in chain.steps_to(frame).iter().rev() {
        let step = &chain.steps[i];
        if step.is_prismatic {
            levers[i] = 1.0;
            cylinder = cylinder.slid(step.lower, step.upper);
        } else {
            levers[i] = if cylinder.radius.is_finite() { cylinder.radius } else { f64::INFINITY };
        }
        cylinder = cylinder.seen_from(&step.at_zero);
    }
    levers
}
