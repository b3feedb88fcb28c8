//! Time to collision from where things are and how fast they go: one look, no search.

use elbowroom_spatial::{Motion, Pose, Vec3};

use super::bound::{Body, Bounds};
use super::{Steady, slab};
use crate::{Separation, Shape};

/// When two moving shapes may meet.
///
/// ```
/// use elbowroom_proximity::impact::time_to_collision;
/// use elbowroom_proximity::{Shape, Sphere, separation};
/// use elbowroom_spatial::{Motion, Pose, Vec3};
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let there = Pose::from_translation(Vec3::X);
/// let near = separation(&ball, &Pose::IDENTITY, &ball, &there); // 0.8 m apart
/// let coming = Motion { velocity: Vec3::X * -0.4, ..Motion::REST };
/// let when = time_to_collision(&near, (&ball, &Pose::IDENTITY, &Motion::REST), (&ball, &there, &coming), 10.0);
/// assert!((when.estimate_s - 2.0).abs() < 1e-9 && (when.earliest_s - 2.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeToCollision {
    /// Distance over closing speed of the nearest points, seconds: right if they are the ones that meet and go on as
    /// they do. Infinite where they do not approach each other. 0 on contact and where a number is not finite.
    pub estimate_s: f64,
    /// Not before this, seconds, so long as velocity and angular velocity stay what they are: proven. At most the
    /// horizon asked for; the horizon itself says that nothing can meet within it.
    pub earliest_s: f64,
}

/// Estimate and proven bound of the time until two shapes meet. Per shape: itself, its pose, and how its frame moves
/// in the world (accelerations are left out); `near` is their [`separation`](crate::separation) now, `horizon_s` how
/// far the bound looks ahead, seconds.
pub fn time_to_collision(
    near: &Separation,
    a: (&Shape, &Pose, &Motion),
    b: (&Shape, &Pose, &Motion),
    horizon_s: f64,
) -> TimeToCollision {
    let path_a = Steady::from_motion(*a.1, a.2, horizon_s);
    let path_b = Steady::from_motion(*b.1, b.2, horizon_s);
    let known = path_a.is_finite() && path_b.is_finite() && horizon_s >= 0.0;
    if !(known && near.lower_bound > 0.0) {
        return TimeToCollision { estimate_s: 0.0, earliest_s: 0.0 };
    }
    let free = earliest(near, (a.0, &path_a), (b.0, &path_b));
    TimeToCollision { estimate_s: estimate(near, a, b), earliest_s: free * horizon_s }
}

/// The part of two motions, in `[0, 1]`, in which the distance certainly does not shrink to 0: the proven half of
/// [`time_to_collision`]. The shapes may be larger than those that `near` was measured of.
///
/// ```
/// use elbowroom_proximity::impact::{Steady, earliest};
/// use elbowroom_proximity::{Shape, Sphere, separation};
/// use elbowroom_spatial::{Pose, Vec3};
/// let ball = Shape::Sphere(Sphere { radius: 0.1 });
/// let (here, there) = (Pose::IDENTITY, Pose::from_translation(Vec3::X));
/// let near = separation(&ball, &here, &ball, &there); // 0.8 m apart
/// let (still, coming) = (Steady::linear(here, Vec3::ZERO), Steady::linear(there, Vec3::X * -1.6));
/// assert!((earliest(&near, (&ball, &still), (&ball, &coming)) - 0.5).abs() < 1e-9);
/// ```
pub fn earliest(near: &Separation, a: (&Shape, &Steady), b: (&Shape, &Steady)) -> f64 {
    if !(a.1.is_finite() && b.1.is_finite() && near.lower_bound > 0.0) {
        return 0.0;
    }
    let (body_a, body_b) = (Body::new(a.0, a.1), Body::new(b.0, b.1));
    let (a_in_world, b_in_world) = (a.1.start, b.1.start);
    let bounds = Bounds { a: &body_a, b: &body_b, a_in_world, b_in_world, t: 0.0 };
    let slab = slab::between(a.0, &a_in_world, b.0, &b_in_world, near);
    let along = slab.map_or(0.0, |(normal, thickness)| bounds.time_for_slab(thickness, normal));
    bounds.time_for(near.lower_bound).max(along).min(1.0)
}

fn estimate(near: &Separation, a: (&Shape, &Pose, &Motion), b: (&Shape, &Pose, &Motion)) -> f64 {
    let velocity = |(_, pose, motion): (&Shape, &Pose, &Motion), p: Vec3| motion.velocity_at(p - pose.translation);
    let relative = velocity(a, near.on_a) - velocity(b, near.on_b);
    let Some(normal) = (near.on_a - near.on_b).try_normalize() else { return 0.0 };
    let closing = -normal.dot(relative);
    if closing > 0.0 { near.distance / closing } else { f64::INFINITY }
}
