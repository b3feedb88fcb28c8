//! Motions over a unit of time, and bounds of their speed.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::constant_twist::ConstantTwist;

/// A rigid motion: the pose of a body as a function of `t` from 0 to 1.
///
/// The proof depends on the speed bounds: a bound that is too large costs steps, a bound that is too small makes the
/// result wrong. A [`Pose`] is the motion of a body at rest; [`ConstantTwist`] covers linear, screw and rotary
/// motion.
///
/// ```
/// use elbowroom_proximity::ccd::{CcdOptions, RigidMotion, time_of_impact};
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_spatial::{Pose, Vec3};
/// /// A ball on a spring: x = 1 m · cos(πt), so never faster than π m per unit of t.
/// struct Spring;
/// impl RigidMotion for Spring {
///     fn pose(&self, t: f64) -> Pose {
///         Pose::from_translation(Vec3::X * (std::f64::consts::PI * t).cos())
///     }
///     fn speed(&self, _radius: f64, _from: f64, _to: f64) -> f64 {
///         std::f64::consts::PI
///     }
/// }
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let there = Pose::from_translation(Vec3::X * -0.2);
/// let hit = time_of_impact(&ball, &Spring, &ball, &there, &CcdOptions::default()).unwrap();
/// assert!((hit.time - 0.5).abs() < 1e-3); // cos(πt) = 0
/// ```
pub trait RigidMotion {
    /// Pose of the body in the world (metres) at `t` in `[0, 1]`.
    fn pose(&self, t: f64) -> Pose;

    /// Upper bound of the speed, in metres per unit of `t`, of the body's points within `radius` metres of its frame's
    /// origin, at any time between `from` and `to`. Must not grow when the interval shrinks.
    fn speed(&self, radius: f64, from: f64, to: f64) -> f64;

    /// Upper bound, as [`RigidMotion::speed`], of the velocity component along a unit vector of the world. May be
    /// negative if all of these points move the other way. The default is the speed.
    fn speed_along(&self, direction: Vec3, radius: f64, from: f64, to: f64) -> f64 {
        let _ = direction;
        self.speed(radius, from, to)
    }

    /// The whole motion, if its twist is constant; pairs of such motions have much tighter bounds.
    fn constant_twist(&self) -> Option<ConstantTwist> {
        None
    }
}

impl RigidMotion for Pose {
    fn pose(&self, _t: f64) -> Pose {
        *self
    }

    fn speed(&self, _radius: f64, _from: f64, _to: f64) -> f64 {
        0.0
    }

    fn constant_twist(&self) -> Option<ConstantTwist> {
        Some(ConstantTwist::linear(*self, Vec3::ZERO))
    }
}

impl RigidMotion for ConstantTwist {
    fn pose(&self, t: f64) -> Pose {
        if !self.is_finite() {
            // A rotation vector with NaN would give the identity.
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

    fn constant_twist(&self) -> Option<ConstantTwist> {
        Some(*self)
    }
}
