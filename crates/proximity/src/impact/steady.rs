//! A point of the body goes straight, the body turns about it at a constant rate: linear, rotary and screw motion.

use elbowroom_spatial::{Motion, Pose, Rotation, Vec3};

use super::Path;

/// Motion with constant velocity and constant angular velocity of one point of the body, over `t` in `[0, 1]`.
///
/// Every motion of one constant twist is of this kind: a screw's point on the axis goes straight along it. So is a
/// straight line of the frame's origin with a constant turn, the linear move of a robot's tool.
///
/// ```
/// use elbowroom_proximity::impact::{Path, Steady};
/// use elbowroom_spatial::{Pose, Rotation, Vec3};
/// // A quarter turn about the world's z axis and 0.1 m up.
/// let start = Pose::from_translation(Vec3::X);
/// let screw = Steady::screw(start, Vec3::ZERO, Vec3::Z * std::f64::consts::FRAC_PI_2, 0.1);
/// assert!((screw.pose(1.0).translation - Vec3::new(0.0, 1.0, 0.1)).length() < 1e-15);
/// assert!((screw.pose(1.0).rotation * Vec3::X - Vec3::Y).length() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steady {
    /// Pose of the body in the world at `t = 0`.
    pub start: Pose,
    /// Where the point that goes straight is at `t = 0`: world, metres.
    pub pivot: Vec3,
    /// Velocity of that point in the world, metres per unit of `t`.
    pub velocity: Vec3,
    /// Angular velocity in the world, radians per unit of `t`; of any size.
    pub rotation: Vec3,
}

impl Steady {
    /// No turning; every point is displaced by `travel` metres (world).
    pub fn linear(start: Pose, travel: Vec3) -> Self {
        Self { start, pivot: start.translation, velocity: travel, rotation: Vec3::ZERO }
    }

    /// A turn by the rotation vector `turn` (world, radians) about the axis through `on_axis` (world, metres), and
    /// `travel` metres along it. Without a turn there is no axis and nothing moves.
    pub fn screw(start: Pose, on_axis: Vec3, turn: Vec3, travel: f64) -> Self {
        let velocity = turn.try_normalize().map_or(turn * travel, |axis| axis * travel);
        Self { start, pivot: on_axis, velocity, rotation: turn }
    }

    /// From one pose to another: the origin goes straight, the body turns the shortest way at a constant rate.
    pub fn straight(from: Pose, to: Pose) -> Self {
        let rotation = (to.rotation * from.rotation.inverse()).to_rotation_vector();
        let broken = Vec3::splat(f64::NAN);
        let known = from.is_finite() && to.is_finite();
        let velocity = if known { to.translation - from.translation } else { broken };
        Self { start: from, pivot: from.translation, velocity, rotation }
    }

    /// From what a frame does now, kept up for `seconds`; accelerations are left out.
    pub fn from_motion(start: Pose, motion: &Motion, seconds: f64) -> Self {
        Self {
            start,
            pivot: start.translation,
            velocity: motion.velocity * seconds,
            rotation: motion.angular_velocity * seconds,
        }
    }

    /// True where no number is NaN or infinite.
    pub fn is_finite(&self) -> bool {
        self.start.is_finite() && self.pivot.is_finite() && self.velocity.is_finite() && self.rotation.is_finite()
    }

    /// Velocity (metres per unit of `t`) of the body's point that is at `p` (world) at time `t`.
    #[inline]
    pub fn velocity_at(&self, p: Vec3, t: f64) -> Vec3 {
        self.velocity + self.turning_at(p, t)
    }

    /// The part of [`Steady::velocity_at`] that is due to turning.
    #[inline]
    pub(super) fn turning_at(&self, p: Vec3, t: f64) -> Vec3 {
        self.rotation.cross(p - (self.pivot + self.velocity * t))
    }

    fn arm(&self) -> f64 {
        (self.start.translation - self.pivot).length()
    }
}

impl Path for Steady {
    fn pose(&self, t: f64) -> Pose {
        if !self.is_finite() {
            // A rotation vector of NaN would read as no turn.
            return Pose::from_translation(Vec3::splat(f64::NAN));
        }
        let turn = Rotation::from_rotation_vector(self.rotation * t);
        let translation = self.pivot + self.velocity * t + turn * (self.start.translation - self.pivot);
        Pose::new(turn * self.start.rotation, translation)
    }

    fn speed(&self, radius: f64, _from: f64, _to: f64) -> f64 {
        self.velocity.length() + self.rotation.length() * (self.arm() + radius)
    }

    fn speed_along(&self, direction: Vec3, radius: f64, _from: f64, _to: f64) -> f64 {
        self.velocity.dot(direction) + self.rotation.cross(direction).length() * (self.arm() + radius)
    }

    fn steady(&self) -> Option<Steady> {
        Some(*self)
    }
}
