//! Bounds of the speed at which a gap closes. README.md in this folder derives them.

use elbowroom_spatial::{Pose, Vec3};

use super::constant_twist::ConstantTwist;
use super::enclosing_points::EnclosingPoints;
use super::rigid_motion::RigidMotion;
use crate::Shape;

/// Factor for the rounding of a dozen operations: speeds are multiplied by it, times divided.
const ROUNDING: f64 = 1.0 + 1e-12;

/// Bound of a quantity that decreases by at most `rate·Δ + ½·growth·Δ²`, and by at most `cap·Δ`.
#[derive(Debug, Clone, Copy)]
pub(super) struct ClosingBound {
    pub rate: f64,
    pub growth: f64,
    pub cap: f64,
}

impl ClosingBound {
    /// Largest possible decrease in `dt`.
    pub fn over(&self, dt: f64) -> f64 {
        let curved = self.rate * dt + 0.5 * self.growth * dt * dt;
        least(curved, self.cap * dt)
    }

    /// A time in which the quantity cannot decrease by `distance`; 0 if no bound is known.
    pub fn time_for(&self, distance: f64) -> f64 {
        if !(distance > 0.0) {
            return 0.0;
        }
        let (r, k) = (self.rate, self.growth);
        let root = (r * r + 2.0 * k * distance).sqrt();
        let curved = if r >= 0.0 { 2.0 * distance / (r + root) } else { (root - r) / k };
        let flat = if self.cap > 0.0 { distance / self.cap } else { f64::INFINITY };
        // Comparisons with NaN are false: a time that is not a number counts as 0.
        let valid = |dt: f64| if dt > 0.0 { dt } else { 0.0 };
        let (curved, flat) = (valid(curved), if self.cap.is_nan() { 0.0 } else { flat });
        curved.max(flat) / ROUNDING
    }
}

/// The smaller number; NaN counts as infinite, because an unknown bound is not a bound.
fn least(a: f64, b: f64) -> f64 {
    let known = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
    known(a).min(known(b))
}

/// A shape, its motion, and the points that bound its speed.
pub(super) struct BoundedShape<'a> {
    pub shape: &'a Shape,
    pub motion: &'a dyn RigidMotion,
    pub twist: Option<ConstantTwist>,
    pub points: Option<EnclosingPoints>,
}

impl<'a> BoundedShape<'a> {
    pub fn new(shape: &'a Shape, motion: &'a dyn RigidMotion) -> Self {
        Self { shape, motion, twist: motion.constant_twist(), points: EnclosingPoints::of(shape) }
    }

    /// Upper bound of the speed of all points, metres per unit of `t`; infinite if unknown.
    fn speed(&self, from: f64, to: f64) -> f64 {
        let radius = self.points.map(|p| p.radius());
        match (radius, self.twist) {
            (Some(radius), _) => self.motion.speed(radius, from, to),
            (None, Some(s)) if s.rotation == Vec3::ZERO => s.velocity.length(),
            _ => f64::INFINITY,
        }
    }

    fn speed_along(&self, direction: Vec3, from: f64, to: f64) -> f64 {
        let radius = self.points.map(|p| p.radius());
        match (radius, self.twist) {
            (Some(radius), _) => self.motion.speed_along(direction, radius, from, to),
            (None, Some(s)) if s.rotation == Vec3::ZERO => s.velocity.dot(direction),
            _ => f64::INFINITY,
        }
    }
}

/// Bounds, at time `t`, of the decrease of the distance of two shapes.
pub(super) struct PairBounds<'a> {
    pub a: &'a BoundedShape<'a>,
    pub b: &'a BoundedShape<'a>,
    pub a_in_world: Pose,
    pub b_in_world: Pose,
    pub t: f64,
}

impl PairBounds<'_> {
    /// Largest possible decrease of the distance until the end of the motion, metres.
    pub fn until_end(&self) -> f64 {
        let left = 1.0 - self.t;
        let apart = (self.a.speed(self.t, 1.0) + self.b.speed(self.t, 1.0)) * left * ROUNDING;
        let together = self.twist_bounds(None).map(|c| c.over(left)).fold(f64::INFINITY, least);
        least(apart, together)
    }

    /// A time during which the distance cannot decrease by `distance` metres.
    pub fn time_for(&self, distance: f64) -> f64 {
        let times = self.twist_bounds(None).map(|c| c.time_for(distance));
        times.fold(self.time_by_speed(distance, &|to| self.a.speed(self.t, to) + self.b.speed(self.t, to)), f64::max)
    }

    /// A time during which a slab of this thickness (metres) perpendicular to `normal` (world, from B to A) stays empty.
    pub fn time_for_slab(&self, thickness: f64, normal: Vec3) -> f64 {
        let times = self.twist_bounds(Some(normal)).map(|c| c.time_for(thickness));
        let speed = |to| self.a.speed_along(-normal, self.t, to) + self.b.speed_along(normal, self.t, to);
        times.fold(self.time_by_speed(thickness, &speed), f64::max)
    }

    /// The longest time with `speed(t + dt)·dt <= distance` that doubling finds.
    fn time_by_speed(&self, distance: f64, speed: &dyn Fn(f64) -> f64) -> f64 {
        let left = 1.0 - self.t;
        let holds = |dt: f64| speed((self.t + dt).min(1.0)) * dt * ROUNDING <= distance;
        if !(distance > 0.0) {
            return 0.0;
        }
        if holds(left) {
            return f64::INFINITY;
        }
        let mut dt = distance / (speed(1.0) * ROUNDING * ROUNDING);
        if !(dt > 0.0) {
            return 0.0;
        }
        while dt < left && holds(2.0 * dt) {
            dt *= 2.0;
        }
        dt
    }

    /// Bounds from the relative velocity at the points of either shape, if both twists are constant.
    fn twist_bounds(&self, normal: Option<Vec3>) -> impl Iterator<Item = ClosingBound> {
        let both = self.a.twist.zip(self.b.twist);
        let sides = both.map(|(a, b)| {
            let translating = a.rotation == Vec3::ZERO && b.rotation == Vec3::ZERO;
            // Without rotation all points have the same velocity, so any point is sufficient.
            let any = translating.then(|| EnclosingPoints::few(&[Vec3::ZERO]));
            [
                self.a.points.or(any).map(|c| closing(&c, &self.a_in_world, &a, &b, self.t, normal)),
                self.b.points.or(any).map(|c| closing(&c, &self.b_in_world, &b, &a, self.t, normal.map(|n| -n))),
            ]
        });
        sides.into_iter().flatten().flatten()
    }
}

/// Bound from the points of a shape with the twist `own`, against a shape with the twist `other`. `normal` points
/// from the other shape to this shape and rotates with the other.
fn closing(
    points: &EnclosingPoints,
    in_world: &Pose,
    own: &ConstantTwist,
    other: &ConstantTwist,
    t: f64,
    normal: Option<Vec3>,
) -> ClosingBound {
    let travel = own.velocity - other.velocity;
    let (mut speed, mut rate, mut turning) = (0.0_f64, f64::NEG_INFINITY, 0.0_f64);
    for &p in points.points() {
        let p = in_world.transform_point(p);
        let own_turning = own.rotational_velocity_at(p, t);
        let relative = travel + own_turning - other.rotational_velocity_at(p, t);
        speed = speed.max(relative.length());
        turning = turning.max(own_turning.length());
        rate = rate.max(normal.map_or(f64::NEG_INFINITY, |n| -n.dot(relative)));
    }
    let other_turn = other.rotation.length();
    let growth = (own.rotation - other.rotation).length() * turning + other.rotation.cross(travel).length();
    let alone = other_turn == 0.0;
    // Rounding is relative to the speeds, not to their difference or component.
    let error = (ROUNDING - 1.0) * (speed + turning + travel.length() + other_turn * arm(points, in_world, other, t));
    match normal {
        None => {
            let cap = if alone { travel.length() + turning } else { f64::INFINITY };
            ClosingBound { rate: speed + error, growth: growth * ROUNDING, cap: cap + error }
        }
        Some(n) => {
            let across = own.rotation.try_normalize().map_or(0.0, |axis| axis.cross(n).length());
            let cap = if alone { -n.dot(travel) + across * turning } else { f64::INFINITY };
            let growth = growth + other_turn * (speed + growth * (1.0 - t));
            ClosingBound { rate: rate + error, growth: growth * ROUNDING, cap: cap + error }
        }
    }
}

/// Largest distance of the points from the pivot of `other`, metres.
fn arm(points: &EnclosingPoints, in_world: &Pose, other: &ConstantTwist, t: f64) -> f64 {
    let pivot = other.pivot + other.velocity * t;
    (in_world.translation - pivot).length() + points.radius()
}
