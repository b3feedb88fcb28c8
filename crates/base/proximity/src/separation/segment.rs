//! Nearest point of a segment to a box (or another segment) or to a cylinder.
//!
//! Along the segment, the squared distance to a convex solid is convex and once differentiable. So half its
//! derivative `g(t)`, the dot product of the direction and the excess over the solid, is monotone. Its root is
//! bracketed by its breakpoints, and computed in between in closed form (box) or by Newton steps (cylinder).

use elbowroom_spatial::Vec3;

use crate::{Cuboid, Cylinder};

/// A segment `middle + t * direction`, `|t| <= half`, in the frame of the solid; `direction` is a unit vector.
#[derive(Debug, Clone, Copy)]
pub(super) struct Segment {
    pub middle: Vec3,
    pub direction: Vec3,
    pub half: f64,
}

impl Segment {
    #[inline]
    pub fn at(&self, t: f64) -> Vec3 {
        self.middle + self.direction * t
    }

    /// Half the derivative of the squared distance to the solid whose nearest point is `nearest`.
    #[inline]
    fn half_derivative(&self, nearest: impl Fn(Vec3) -> Vec3 + Copy) -> impl Fn(f64) -> f64 + Copy {
        move |t| {
            let p = self.at(t);
            (p - nearest(p)).dot(self.direction)
        }
    }

    /// True if a box around the frame's origin is farther than `reach` along one of its axes.
    #[inline]
    pub fn misses(&self, half_extents: Vec3, reach: f64) -> bool {
        self.box_gap(half_extents) > reach
    }

    /// Largest gap along an axis to a box around the frame's origin.
    #[inline]
    pub fn box_gap(&self, half_extents: Vec3) -> f64 {
        (self.middle.abs() - self.direction.abs() * self.half - half_extents).max_element()
    }
}

/// The bracket of the root of a monotone function `g`.
struct Bracket {
    lo: f64,
    hi: f64,
}

impl Bracket {
    /// The bracket at the two ends, or the position of the minimum if the root is not between them.
    #[inline]
    fn start(half: f64, g: impl Fn(f64) -> f64) -> Result<Self, f64> {
        let (g_lo, g_hi) = (g(-half), g(half));
        if g_lo == 0.0 && g_hi == 0.0 {
            return Err(0.0); // equally near everywhere: the middle
        }
        if !(g_lo < 0.0) {
            return Err(-half);
        }
        if !(g_hi > 0.0) {
            return Err(half);
        }
        Ok(Self { lo: -half, hi: half })
    }

    #[inline]
    fn middle(&self) -> f64 {
        0.5 * (self.lo + self.hi)
    }

    #[inline]
    fn tighten(&mut self, t: f64, g: impl Fn(f64) -> f64) {
        if t > self.lo && t < self.hi {
            if g(t) > 0.0 {
                self.hi = t;
            } else {
                self.lo = t;
            }
        }
    }
}

/// The point of the segment nearest to the box. A box with two half extents of 0 is a segment along an axis.
#[inline]
pub(super) fn nearest_to_box(s: &Segment, solid: &Cuboid) -> Vec3 {
    let (c, d, h) = (s.middle, s.direction, solid.half_extents);
    let g = s.half_derivative(|p| solid.nearest(p));
    let mut bracket = match Bracket::start(s.half, g) {
        Ok(bracket) => bracket,
        Err(t) => return s.at(t),
    };
    for k in 0..3 {
        if d[k] != 0.0 {
            bracket.tighten((h[k] - c[k]) / d[k], g);
            bracket.tighten((-h[k] - c[k]) / d[k], g);
        }
    }
    // The function is linear in between: the set of nonzero excesses is constant, and the middle of the piece shows it.
    let mid = bracket.middle();
    let p = s.at(mid);
    let excess = p - solid.nearest(p);
    let square = |k: usize| if excess[k] == 0.0 { 0.0 } else { d[k] * d[k] };
    let slope = square(0) + square(1) + square(2);
    if slope == 0.0 {
        return p;
    }
    s.at((mid - excess.dot(d) / slope).max(bracket.lo).min(bracket.hi))
}

/// The point of the segment nearest to the cylinder.
pub(super) fn nearest_to_cylinder(s: &Segment, solid: &Cylinder) -> Vec3 {
    let (c, d) = (s.middle, s.direction);
    let (r, h) = (solid.radius, solid.half_length);
    let g = s.half_derivative(|p| solid.nearest(p));
    let mut bracket = match Bracket::start(s.half, g) {
        Ok(bracket) => bracket,
        Err(t) => return s.at(t),
    };
    // A few steps from the point nearest to the axis are mostly sufficient.
    let across2 = d.x * d.x + d.y * d.y;
    let crossing = if across2 > 0.0 { -(c.x * d.x + c.y * d.y) / across2 } else { 0.0 };
    let start = crossing.max(-0.9 * s.half).min(0.9 * s.half);
    if let Ok(t) = newton(s, solid, &mut bracket, start, QUICK_STEPS) {
        return s.at(t);
    }
    if d.z != 0.0 {
        bracket.tighten((h - c.z) / d.z, g);
        bracket.tighten((-h - c.z) / d.z, g);
    }
    if across2 > 0.0 {
        // The point nearest to the axis, and the intersections with the lateral surface.
        bracket.tighten(crossing, g);
        let across = across2.sqrt();
        let off_axis = (c.x * d.y - c.y * d.x).abs() / across;
        if off_axis < r {
            let half_chord = ((r - off_axis) * (r + off_axis)).sqrt() / across;
            bracket.tighten(crossing - half_chord, g);
            bracket.tighten(crossing + half_chord, g);
        }
    }
    let middle = bracket.middle();
    let (Ok(t) | Err(t)) = newton(s, solid, &mut bracket, middle, MAX_STEPS);
    s.at(t)
}

/// Number of Newton steps before the bracket is tightened by the breakpoints of `g`.
const QUICK_STEPS: usize = 8;
/// Largest number of Newton steps after that.
const MAX_STEPS: usize = 60;

/// Newton steps on `g` inside the bracket; bisects the bracket if a step leaves it. The last position is an error if
/// the steps have not converged.
#[inline]
fn newton(s: &Segment, solid: &Cylinder, bracket: &mut Bracket, start: f64, steps: usize) -> Result<f64, f64> {
    let d = s.direction;
    let mut t = start;
    for _ in 0..steps {
        let p = s.at(t);
        let excess = p - solid.nearest(p);
        let value = excess.dot(d);
        if value == 0.0 {
            return Ok(t);
        }
        if value > 0.0 {
            bracket.hi = t;
        } else {
            bracket.lo = t;
        }
        let rho = (p.x * p.x + p.y * p.y).sqrt();
        let mut slope = if excess.z == 0.0 { 0.0 } else { d.z * d.z };
        if rho > solid.radius {
            let rate = (p.x * d.x + p.y * d.y) / rho;
            let across2 = d.x * d.x + d.y * d.y;
            slope += rate * rate + (rho - solid.radius) / rho * (across2 - rate * rate).max(0.0);
        }
        let mut next = t - value / slope;
        if !(next > bracket.lo && next < bracket.hi) {
            next = 0.5 * (bracket.lo + bracket.hi);
        }
        let done = (next - t).abs() <= 4.0 * f64::EPSILON * (s.half + t.abs());
        t = next;
        if done {
            return Ok(t);
        }
    }
    Err(t)
}
