//! Motions over a unit of time, and the bounds of their speed.

use elbowroom_spatial::{Pose, Rotation, Vec3};

use super::constant_twist::ConstantTwist;

/// A rigid motion: the pose of a body as a function of `t` from 0 to 1.
///
/// The proof rests on the speed bounds: one that is too large costs steps, one that is too small makes the result wrong. A
/// [`Pose`] is the motion of a body at rest; [`ConstantTwist`] is linear, screw and rotary motion.
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
    /// Pose of the body in the world at `t` in `[0, 1]`, metres.
    fn pose(&self, t: f64) -> Pose;

    /// Upper bound of the speed of the body's points within `radius` metres of its frame's origin, anywhere between `from`
    /// and `to`: metres per unit of `t`. Must not grow when the interval shrinks.
    fn speed(&self, radius: f64, from: f64, to: f64) -> f64;

    /// The same for the component of the velocity along a unit vector of the world; may be negative if all those points
    /// move the other way. By default the speed.
    fn speed_along(&self, direction: Vec3, radius: f64, from: f64, to: f64) -> f64 {
        let _ = direction;
        self.speed(radius, from, to)
    }

    /// The whole motion, where its twist is constant: pairs of such motions have far sharper bounds.
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
            // A rotation vector of NaN would give the identity.
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
