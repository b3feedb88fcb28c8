//! How fast a gap can close. See the derivation in README.md beside this file.

use elbowroom_spatial::{Pose, Vec3};

use super::carrier::Carrier;
use super::{Path, Steady};
use crate::Shape;

/// Factor on speeds and off times for the rounding of a dozen operations.
const CAREFUL: f64 = 1.0 + 1e-12;

/// A quantity that decreases by at most `rate·Δ + ½·growth·Δ²`, and by at most `cap·Δ`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Closing {
    pub rate: f64,
    pub growth: f64,
    pub cap: f64,
}

impl Closing {
    /// The most it can decrease in `dt`.
    pub fn over(&self, dt: f64) -> f64 {
        let curved = self.rate * dt + 0.5 * self.growth * dt * dt;
        least(curved, self.cap * dt)
    }

    /// A time during which it cannot decrease by `room`; 0 where nothing is known.
    pub fn time_for(&self, room: f64) -> f64 {
        if !(room > 0.0) {
            return 0.0;
        }
        let (r, k) = (self.rate, self.growth);
        let root = (r * r + 2.0 * k * room).sqrt();
        let curved = if r >= 0.0 { 2.0 * room / (r + root) } else { (root - r) / k };
        let flat = if self.cap > 0.0 { room / self.cap } else { f64::INFINITY };
        // Comparisons with NaN are false: what cannot be computed gives no time.
        let valid = |dt: f64| if dt > 0.0 { dt } else { 0.0 };
        let (curved, flat) = (valid(curved), if self.cap.is_nan() { 0.0 } else { flat });
        curved.max(flat) / CAREFUL
    }
}

/// The smaller number; NaN counts as infinite, because an unknown bound bounds nothing.
fn least(a: f64, b: f64) -> f64 {
    let known = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
    known(a).min(known(b))
}

/// One shape, how it moves, and where its telling points are.
pub(super) struct Body<'a> {
    pub shape: &'a Shape,
    pub path: &'a dyn Path,
    pub steady: Option<Steady>,
    pub carrier: Option<Carrier>,
}

impl<'a> Body<'a> {
    pub fn new(shape: &'a Shape, path: &'a dyn Path) -> Self {
        Self { shape, path, steady: path.steady(), carrier: Carrier::of(shape) }
    }

    /// Metres per unit of `t` that no point exceeds, infinite where unknown.
    fn speed(&self, from: f64, to: f64) -> f64 {
        let radius = self.carrier.map(|c| c.radius());
        match (radius, self.steady) {
            (Some(radius), _) => self.path.speed(radius, from, to),
            (None, Some(s)) if s.rotation == Vec3::ZERO => s.velocity.length(),
            _ => f64::INFINITY,
        }
    }

    fn speed_along(&self, direction: Vec3, from: f64, to: f64) -> f64 {
        let radius = self.carrier.map(|c| c.radius());
        match (radius, self.steady) {
            (Some(radius), _) => self.path.speed_along(direction, radius, from, to),
            (None, Some(s)) if s.rotation == Vec3::ZERO => s.velocity.dot(direction),
            _ => f64::INFINITY,
        }
    }
}

/// What is known at time `t` about how the two can come nearer.
pub(super) struct Bounds<'a> {
    pub a: &'a Body<'a>,
    pub b: &'a Body<'a>,
    pub a_in_world: Pose,
    pub b_in_world: Pose,
    pub t: f64,
}

impl Bounds<'_> {
    /// The most that the distance can shrink until the end of the motion, metres.
    pub fn until_end(&self) -> f64 {
        let left = 1.0 - self.t;
        let apart = (self.a.speed(self.t, 1.0) + self.b.speed(self.t, 1.0)) * left * CAREFUL;
        let together = self.steady_pairs(None).map(|c| c.over(left)).fold(f64::INFINITY, least);
        least(apart, together)
    }

    /// A time during which a distance cannot shrink by `room` metres.
    pub fn time_for(&self, room: f64) -> f64 {
        let pairs = self.steady_pairs(None).map(|c| c.time_for(room));
        pairs.fold(self.grown(room, &|to| self.a.speed(self.t, to) + self.b.speed(self.t, to)), f64::max)
    }

    /// A time during which a slab of `room` metres perpendicular to `normal` (world, from B to A) stays empty.
    pub fn time_for_slab(&self, room: f64, normal: Vec3) -> f64 {
        let pairs = self.steady_pairs(Some(normal)).map(|c| c.time_for(room));
        let speed = |to| self.a.speed_along(-normal, self.t, to) + self.b.speed_along(normal, self.t, to);
        pairs.fold(self.grown(room, &speed), f64::max)
    }

    /// The longest time found with `speed(t + dt)·dt <= room`, by doubling.
    fn grown(&self, room: f64, speed: &dyn Fn(f64) -> f64) -> f64 {
        let left = 1.0 - self.t;
        let holds = |dt: f64| speed((self.t + dt).min(1.0)) * dt * CAREFUL <= room;
        if !(room > 0.0) {
            return 0.0;
        }
        if holds(left) {
            return f64::INFINITY;
        }
        let mut dt = room / (speed(1.0) * CAREFUL * CAREFUL);
        if !(dt > 0.0) {
            return 0.0;
        }
        while dt < left && holds(2.0 * dt) {
            dt *= 2.0;
        }
        dt
    }

    /// Bounds from the relative velocity at the points of the one and of the other.
    fn steady_pairs(&self, normal: Option<Vec3>) -> impl Iterator<Item = Closing> {
        let both = self.a.steady.zip(self.b.steady);
        let sides = both.map(|(a, b)| {
            let still = a.rotation == Vec3::ZERO && b.rotation == Vec3::ZERO;
            // Where nothing turns, all points move alike and any point tells.
            let any = still.then(|| Carrier::few(&[Vec3::ZERO]));
            [
                self.a.carrier.or(any).map(|c| closing(&c, &self.a_in_world, &a, &b, self.t, normal)),
                self.b.carrier.or(any).map(|c| closing(&c, &self.b_in_world, &b, &a, self.t, normal.map(|n| -n))),
            ]
        });
        sides.into_iter().flatten().flatten()
    }
}

/// From the points of a carrier that moves as `own`, against a body that moves as `other`; `normal` leads from the
/// other to the carrier and turns with the other.
fn closing(carrier: &Carrier, in_world: &Pose, own: &Steady, other: &Steady, t: f64, normal: Option<Vec3>) -> Closing {
    let travel = own.velocity - other.velocity;
    let (mut speed, mut rate, mut turning) = (0.0_f64, f64::NEG_INFINITY, 0.0_f64);
    for &p in carrier.points() {
        let p = in_world.transform_point(p);
        let own_turning = own.turning_at(p, t);
        let relative = travel + own_turning - other.turning_at(p, t);
        speed = speed.max(relative.length());
        turning = turning.max(own_turning.length());
        rate = rate.max(normal.map_or(f64::NEG_INFINITY, |n| -n.dot(relative)));
    }
    let other_turn = other.rotation.length();
    let growth = (own.rotation - other.rotation).length() * turning + other.rotation.cross(travel).length();
    let alone = other_turn == 0.0;
    // Rounding is relative to the speeds, not to their difference or component.
    let doubt = (CAREFUL - 1.0) * (speed + turning + travel.length() + other_turn * arm(carrier, in_world, other, t));
    match normal {
        None => {
            let cap = if alone { travel.length() + turning } else { f64::INFINITY };
            Closing { rate: speed + doubt, growth: growth * CAREFUL, cap: cap + doubt }
        }
        Some(n) => {
            let across = own.rotation.try_normalize().map_or(0.0, |axis| axis.cross(n).length());
            let cap = if alone { -n.dot(travel) + across * turning } else { f64::INFINITY };
            let growth = growth + other_turn * (speed + growth * (1.0 - t));
            Closing { rate: rate + doubt, growth: growth * CAREFUL, cap: cap + doubt }
        }
    }
}

/// Largest distance of the carrier's points from the pivot of `other`, metres.
fn arm(carrier: &Carrier, in_world: &Pose, other: &Steady, t: f64) -> f64 {
    let pivot = other.pivot + other.velocity * t;
    (in_world.translation - pivot).length() + carrier.radius()
}
