//! Motion with a constant twist: linear, rotary and screw motion.

use elbowroom_spatial::{FrameMotion, Pose, Vec3};

/// Motion with constant angular velocity, and constant velocity of one point of the body, the pivot, over `t` in
/// `[0, 1]`.
///
/// Every screw motion is such a motion: its pivot moves along the axis. So is the linear move of a robot's tool: a
/// linear motion of the frame's origin with a constant rotation.
///
/// ```
/// use elbowroom_proximity::ccd::{ConstantTwist, RigidMotion};
/// use elbowroom_spatial::{Pose, Rotation, Vec3};
/// // A quarter turn about the world's z axis and 0.1 m up.
/// let start = Pose::from_translation(Vec3::X);
/// let screw = ConstantTwist::screw(start, Vec3::ZERO, Vec3::Z * std::f64::consts::FRAC_PI_2, 0.1);
/// assert!((screw.pose(1.0).translation - Vec3::new(0.0, 1.0, 0.1)).length() < 1e-15);
/// assert!((screw.pose(1.0).rotation * Vec3::X - Vec3::Y).length() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConstantTwist {
    /// Pose of the body in the world at `t = 0`.
    pub start: Pose,
    /// The pivot at `t = 0`, in the world, metres.
    pub pivot: Vec3,
    /// Velocity of the pivot in the world, metres per unit of `t`.
    pub velocity: Vec3,
    /// Angular velocity in the world, radians per unit of `t`; may be of any size.
    pub rotation: Vec3,
}

impl ConstantTwist {
    /// A motion without rotation that displaces every point by `travel` metres (world).
    pub fn linear(start: Pose, travel: Vec3) -> Self {
        Self { start, pivot: start.translation, velocity: travel, rotation: Vec3::ZERO }
    }

    /// A rotation by the rotation vector `turn` (world, radians) about the axis through `on_axis` (world, metres), and a
    /// travel of `travel` metres along it. If `turn` is zero, the axis is undefined and nothing moves.
    pub fn screw(start: Pose, on_axis: Vec3, turn: Vec3, travel: f64) -> Self {
        let velocity = turn.try_normalize().map_or(turn * travel, |axis| axis * travel);
        Self { start, pivot: on_axis, velocity, rotation: turn }
    }

    /// A motion from one pose to another: the origin moves straight, the rotation is the shortest, both at a constant
    /// rate.
    pub fn straight(from: Pose, to: Pose) -> Self {
        let rotation = (to.rotation * from.rotation.inverse()).to_rotation_vector();
        let invalid = Vec3::splat(f64::NAN);
        let is_finite = from.is_finite() && to.is_finite();
        let velocity = if is_finite { to.translation - from.translation } else { invalid };
        Self { start: from, pivot: from.translation, velocity, rotation }
    }

    /// The present velocities of a frame, held for `seconds`; accelerations are ignored.
    pub fn from_motion(start: Pose, motion: &FrameMotion, seconds: f64) -> Self {
        Self {
            start,
            pivot: start.translation,
            velocity: motion.velocity * seconds,
            rotation: motion.angular_velocity * seconds,
        }
    }

    /// True if no number is NaN or infinite.
    pub fn is_finite(&self) -> bool {
        self.start.is_finite() && self.pivot.is_finite() && self.velocity.is_finite() && self.rotation.is_finite()
    }

    /// Velocity (metres per unit of `t`) of the body's point at `p` (world, metres) at time `t`.
    #[inline]
    pub fn velocity_at(&self, p: Vec3, t: f64) -> Vec3 {
        self.velocity + self.rotational_velocity_at(p, t)
    }

    /// The part of [`ConstantTwist::velocity_at`] that is due to rotation.
    #[inline]
    pub(super) fn rotational_velocity_at(&self, p: Vec3, t: f64) -> Vec3 {
        self.rotation.cross(p - (self.pivot + self.velocity * t))
    }

    /// Distance of the frame's origin from the pivot, metres.
    pub(super) fn arm(&self) -> f64 {
        (self.start.translation - self.pivot).length()
    }
}
