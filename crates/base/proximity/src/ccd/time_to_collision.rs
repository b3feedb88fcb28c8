//! Time to collision from the present poses and velocities: one distance, without iteration.

use elbowroom_spatial::{FrameMotion, Pose, Vec3};

use super::closing_bound::{BoundedShape, PairBounds};
use super::constant_twist::ConstantTwist;
use super::separating_slab::separating_slab;
use crate::{Separation, Shape};

/// Estimate and lower bound of the time until two moving shapes meet.
///
/// ```
/// use elbowroom_proximity::ccd::{MovingShape, time_to_collision};
/// use elbowroom_proximity::{Shape, Sphere, separation};
/// use elbowroom_spatial::{FrameMotion, Pose, Vec3};
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let there = Pose::from_translation(Vec3::X);
/// let near = separation(&ball, &Pose::IDENTITY, &ball, &there); // 0.8 m apart
/// let approaching = FrameMotion { velocity: Vec3::X * -0.4, ..FrameMotion::REST };
/// let a = MovingShape { shape: &ball, in_world: &Pose::IDENTITY, motion: &FrameMotion::REST };
/// let b = MovingShape { shape: &ball, in_world: &there, motion: &approaching };
/// let when = time_to_collision(&near, a, b, 10.0);
/// assert!((when.estimate_s - 2.0).abs() < 1e-9 && (when.earliest_s - 2.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeToCollision {
    /// Distance over closing speed of the nearest points, seconds: correct if these points meet and keep their
    /// velocities. Infinite if they do not approach each other; 0 on contact, or if a number is not finite.
    pub estimate_s: f64,
    /// Proven lower bound of the time, seconds, while velocity and angular velocity are constant. At most the horizon;
    /// the horizon itself means that the shapes do not touch within it.
    pub earliest_s: f64,
}

/// A shape, its pose, and the motion of its frame in the world.
#[derive(Debug, Clone, Copy)]
pub struct MovingShape<'a> {
    /// The shape.
    pub shape: &'a Shape,
    /// The shape's pose now.
    pub in_world: &'a Pose,
    /// Velocity and angular velocity of the shape's frame; accelerations are ignored.
    pub motion: &'a FrameMotion,
}

impl MovingShape<'_> {
    fn twist(&self, seconds: f64) -> ConstantTwist {
        ConstantTwist::from_motion(*self.in_world, self.motion, seconds)
    }

    fn velocity_at(&self, p: Vec3) -> Vec3 {
        self.motion.velocity_at(p - self.in_world.translation)
    }
}

/// Estimate and proven bound of the time until two shapes meet.
///
/// `near` is their present [`separation`](crate::separation()). `horizon_s` is the time, in seconds, for which the
/// bound is computed.
pub fn time_to_collision(near: &Separation, a: MovingShape, b: MovingShape, horizon_s: f64) -> TimeToCollision {
    let (twist_a, twist_b) = (a.twist(horizon_s), b.twist(horizon_s));
    let is_finite = twist_a.is_finite() && twist_b.is_finite() && horizon_s >= 0.0;
    if !(is_finite && near.lower_bound > 0.0) {
        return TimeToCollision { estimate_s: 0.0, earliest_s: 0.0 };
    }
    let free = contact_free_fraction(near, a.shape, &twist_a, b.shape, &twist_b);
    TimeToCollision { estimate_s: estimate(near, a, b), earliest_s: free * horizon_s }
}

/// The fraction of two motions, in `[0, 1]`, during which the distance is guaranteed not to reach 0.
///
/// This is the proven half of [`time_to_collision`]. The shapes may be larger than the shapes for which `near` was
/// measured.
///
/// ```
/// use elbowroom_proximity::ccd::{ConstantTwist, contact_free_fraction};
/// use elbowroom_proximity::{Shape, Sphere, separation};
/// use elbowroom_spatial::{Pose, Vec3};
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let (here, there) = (Pose::IDENTITY, Pose::from_translation(Vec3::X));
/// let near = separation(&ball, &here, &ball, &there); // 0.8 m apart
/// let (at_rest, approaching) = (ConstantTwist::linear(here, Vec3::ZERO), ConstantTwist::linear(there, Vec3::X * -1.6));
/// assert!((contact_free_fraction(&near, &ball, &at_rest, &ball, &approaching) - 0.5).abs() < 1e-9);
/// ```
pub fn contact_free_fraction(
    near: &Separation,
    a: &Shape,
    a_motion: &ConstantTwist,
    b: &Shape,
    b_motion: &ConstantTwist,
) -> f64 {
    if !(a_motion.is_finite() && b_motion.is_finite() && near.lower_bound > 0.0) {
        return 0.0;
    }
    let (bounded_a, bounded_b) = (BoundedShape::new(a, a_motion), BoundedShape::new(b, b_motion));
    let (a_in_world, b_in_world) = (a_motion.start, b_motion.start);
    let bounds = PairBounds { a: &bounded_a, b: &bounded_b, a_in_world, b_in_world, t: 0.0 };
    let slab = separating_slab(a, &a_in_world, b, &b_in_world, near);
    let by_slab = slab.map_or(0.0, |slab| bounds.time_for_slab(slab.thickness, slab.normal));
    bounds.time_for(near.lower_bound).max(by_slab).min(1.0)
}

fn estimate(near: &Separation, a: MovingShape, b: MovingShape) -> f64 {
    let relative = a.velocity_at(near.on_a) - b.velocity_at(near.on_b);
    let Some(normal) = (near.on_a - near.on_b).try_normalize() else { return 0.0 };
    let closing = -normal.dot(relative);
    if closing > 0.0 { near.distance / closing } else { f64::INFINITY }
}
