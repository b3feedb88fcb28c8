//! What a motion must tell about itself before anything can be proven about it.

use elbowroom_spatial::{Pose, Vec3};

use super::Steady;

/// How a body moves while `t` goes from 0 to 1.
///
/// The speed bounds are what every "free" rests on: a bound that is too large costs steps, one that is too small costs
/// the truth. A [`Pose`] is the path of a body that stands still; [`Steady`] is straight, screw and rotary motion.
///
/// ```
/// use elbowroom_proximity::impact::{Options, Path, time_of_impact};
/// use elbowroom_proximity::{Shape, Sphere};
/// use elbowroom_spatial::{Pose, Vec3};
/// /// A ball on a spring: x = 1 m · cos(πt), so never faster than π m per unit of t.
/// struct Spring;
/// impl Path for Spring {
///     fn pose(&self, t: f64) -> Pose {
///         Pose::from_translation(Vec3::X * (std::f64::consts::PI * t).cos())
///     }
///     fn speed(&self, _radius: f64, _from: f64, _to: f64) -> f64 {
///         std::f64::consts::PI
///     }
/// }
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let there = Pose::from_translation(Vec3::X * -0.2);
/// let hit = time_of_impact(&ball, &Spring, &ball, &there, &Options::default()).unwrap();
/// assert!((hit.time - 0.5).abs() < 1e-3); // cos(πt) = 0
/// ```
pub trait Path {
    /// Pose of the body in the world at `t` in `[0, 1]`, metres.
    fn pose(&self, t: f64) -> Pose;

    /// No point of the body within `radius` metres of its frame's origin is faster than this anywhere between `from`
    /// and `to`: metres per unit of `t`. Must not grow when the interval shrinks.
    fn speed(&self, radius: f64, from: f64, to: f64) -> f64;

    /// The same for the component along a unit vector of the world; may be negative where all those points move the
    /// other way. Without knowledge: the speed.
    fn speed_along(&self, direction: Vec3, radius: f64, from: f64, to: f64) -> f64 {
        let _ = direction;
        self.speed(radius, from, to)
    }

    /// The whole motion, where it is a steady one: pairs of such motions have bounds far sharper than speeds.
    fn steady(&self) -> Option<Steady> {
        None
    }
}

impl Path for Pose {
    fn pose(&self, _t: f64) -> Pose {
        *self
    }

    fn speed(&self, _radius: f64, _from: f64, _to: f64) -> f64 {
        0.0
    }

    fn steady(&self) -> Option<Steady> {
        Some(Steady::linear(*self, Vec3::ZERO))
    }
}
