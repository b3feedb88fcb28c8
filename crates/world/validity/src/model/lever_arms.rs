//! Lever arms: the largest distances of the points of a body from the axes of the joints that move it.
//!
//! The body is enclosed in a cylinder about the axis of its own joint. A turn about that axis leaves the cylinder
//! unchanged; a slide along the axis makes it longer. This cylinder is then enclosed in a cylinder about the axis of the
//! previous joint, and so on to the base. The radii are the lever arms, whatever the joint values are.

use super::axis_cylinder::AxisCylinder;
use super::forward::BatchedChain;
use crate::cover::Ball;

/// Quantities with which the rounding errors of a body's points grow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Reach {
    /// Number of joints that move the body.
    pub joints: usize,
    /// Sum over these joints of the largest distance of a point of the body from the joint's origin, m.
    pub arms_m: f64,
    /// Largest distance of a point of the body, or of an origin on the path to it, from the origin of the world, m.
    pub world_m: f64,
}

impl Reach {
    /// The reach of a body whose points are within `radius_m` of the origin of its joint's frame.
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

/// Computes the lever arm of a body per step of the chain.
///
/// For a turning joint, it is the largest distance of a point of the body from the axis (m); for a slide 1; for a joint
/// that does not move the body 0. The balls are in the frame of the body's joint.
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
