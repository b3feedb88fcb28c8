//! Bound of the motion of a piece within a box of joint space.
//!
//! From the centre of the box to any of its points, at constant rates in a unit of time, a point x of the piece starts
//! with the velocity V = Σ δᵢ·vᵢ(x). Here vᵢ(x) = aᵢ × (x − oᵢ) for a rotating joint and aᵢ for a prismatic one. With x
//! = c + r and |r| ≤ R (the ball around the piece)
//!
//! |V|  ≤  |Σ δᵢ·vᵢ(c)| + R·|Σ δᵢ·aᵢ|,   |Σ δᵢ·uᵢ|²  ≤  Σ hᵢ²|uᵢ|² + 2 Σ_{i<j} hᵢ·hⱼ·|uᵢ·uⱼ|   for all |δᵢ| ≤ hᵢ.
//!
//! In that time the velocity changes at most by the growth Σⱼ (hⱼ + 2 Σ_{i<j} hᵢ)·hⱼ·Lⱼ (derived in the scene's
//! `sweep/README.md`; Lⱼ bounds the distance from axis j), which adds half of it to the displacement. Also, no point
//! moves farther than Σ hⱼ·Lⱼ.

use elbowroom_kinematics::ChainState;
use elbowroom_kinematics::motion_bound::{JointRate, SpeedBound};
use elbowroom_spatial::Vec3;

use super::driven_chain::{DrivenChain, DrivingJoint};
use super::robot_pieces::RobotPiece;
use super::settings::MAX_JOINTS;

/// Velocities of a piece per unit of each axis of the map, at one configuration.
#[derive(Debug, Clone, Copy)]
pub(super) struct MotionBound {
    /// Velocity of the ball's centre per unit of each axis.
    linear: [Vec3; MAX_JOINTS],
    /// Angular velocity per unit of each axis.
    angular: [Vec3; MAX_JOINTS],
    /// Centre of the ball around the piece, in the world.
    pub center: Vec3,
    depth: usize,
}

/// Accuracy of distances, metres: a smaller gap counts as 0.
const DISTANCE_TOLERANCE_M: f64 = 1e-9;

impl MotionBound {
    pub fn new(piece: &RobotPiece, chain: &DrivenChain, state: &ChainState) -> Self {
        let center = chain.link_in_world(state, piece.link).transform_point(piece.center);
        let mut bound =
            Self { linear: [Vec3::ZERO; MAX_JOINTS], angular: [Vec3::ZERO; MAX_JOINTS], center, depth: piece.depth };
        for joint in &piece.joints {
            let in_world = chain.link_in_world(state, joint.child);
            let along = in_world.transform_vector(joint.along) * joint.multiplier;
            if joint.turns {
                bound.linear[joint.axis] += along.cross(center - in_world.translation);
                bound.angular[joint.axis] += along;
            } else {
                bound.linear[joint.axis] += along;
            }
        }
        bound
    }

    /// Bound of the displacement of any point of the piece within a box with these half widths, metres.
    pub fn max_displacement(&self, piece: &RobotPiece, half: &[f64]) -> f64 {
        let (cap, growth) = path_length_and_growth(piece, half);
        let linear = max_weighted_sum(&self.linear, half, self.depth);
        let first_order = linear + piece.radius * max_weighted_sum(&self.angular, half, self.depth);
        cap.min(first_order + 0.5 * growth) * (1.0 + 1e-9) + DISTANCE_TOLERANCE_M
    }

    /// Bound of the displacement of one point of the piece (in the world) within a box with these half widths, metres.
    pub fn max_point_displacement(&self, piece: &RobotPiece, half: &[f64], p: Vec3) -> f64 {
        let mut linear = self.linear;
        for (axis, v) in linear.iter_mut().enumerate().take(self.depth) {
            *v = self.point_velocity(axis, p);
        }
        let (cap, growth) = path_length_and_growth(piece, half);
        cap.min(max_weighted_sum(&linear, half, self.depth) + 0.5 * growth) * (1.0 + 1e-9) + DISTANCE_TOLERANCE_M
    }

    /// Displacement by one axis, metres, to first order.
    pub fn axis_displacement(&self, piece: &RobotPiece, axis: usize, half: &[f64]) -> f64 {
        half[axis] * (self.linear[axis].length() + piece.radius * self.angular[axis].length())
    }

    /// Velocity of a point of the piece (in the world) per unit of an axis.
    pub fn point_velocity(&self, axis: usize, p: Vec3) -> Vec3 {
        self.linear[axis] + self.angular[axis].cross(p - self.center)
    }
}

/// Bound of the path length of any point of a piece, and the growth.
fn path_length_and_growth(piece: &RobotPiece, half: &[f64]) -> (f64, f64) {
    let joint_rate = |(joint, lever_m): (&DrivingJoint, &f64)| {
        let rate = half[joint.axis] * joint.multiplier.abs();
        if joint.turns { JointRate::Revolute { rate, lever_m: *lever_m } } else { JointRate::Prismatic { rate } }
    };
    // In a unit of time, the length of the path equals the speed, and the change of the velocity equals the
    // acceleration.
    let bound = SpeedBound::of_joints(piece.joints.iter().zip(&piece.lever_arms).map(joint_rate));
    (bound.speed, bound.acceleration)
}

/// Bound of |Σ δᵢ·uᵢ| over all |δᵢ| ≤ hᵢ.
fn max_weighted_sum(u: &[Vec3; MAX_JOINTS], half: &[f64], depth: usize) -> f64 {
    let mut sum = 0.0;
    for i in 0..depth {
        sum += half[i] * half[i] * u[i].length_squared();
        for j in 0..i {
            sum += 2.0 * half[i] * half[j] * u[i].dot(u[j]).abs();
        }
    }
    sum.sqrt()
}
