//! The kernel of slices: tests sixteen balls of the robot against a ring about the first joint's axis.
//!
//! The section of the ring is a rectangle of radius and height, so the value of the first joint does not matter: a ball
//! touches the ring if the ball's radius and height touch the rectangle. A box of the two other joints is free of a
//! ball if a line separates the ball's radius and height from the rectangle in the whole box. The line is perpendicular
//! to the shortest connection at the centre of the box. The angles that a ball covers where it may touch the ring give
//! the values of the first joint at which it may touch a sector of the ring.

#![allow(clippy::inline_always, reason = "a kernel is compiled for each instruction set as a whole")]

use elbowroom_validity::lanes::simd::{Select, Simd, f32x16, prelude::*};
use elbowroom_validity::lanes::{LANES, Row, splat};

use super::cover_class::{CoverGroup, GroupMotion};
use super::kernel::GroupPlace;
use crate::planar_map::simd_math::{ANGLE_ERROR, atan2};

/// Distance from the axis, m, below which the direction from the axis is not defined.
const LEAST_RADIUS_M: f32 = 1e-6;

/// The rectangle of a ring, m.
#[derive(Debug, Clone, Copy)]
pub(super) struct RingSection {
    /// Radii, m.
    pub near: f32,
    pub far: f32,
    /// Heights, m.
    pub low: f32,
    pub high: f32,
    /// Allowance for rounding errors, m.
    pub rounding: f32,
}

/// Results for sixteen balls in a box.
#[derive(Debug, Clone, Copy)]
pub(super) struct RingContact {
    /// Balls that are not proven apart from the ring in the whole box, one bit each.
    pub near: u32,
    /// Balls that touch the ring at the centre of the box and throughout the given motion.
    pub contact: u32,
}

/// Angles that sixteen balls cover, measured from the direction of x or, behind the axis, from the opposite direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct CoveredAngles {
    pub low: [f32; LANES],
    pub high: [f32; LANES],
    /// Balls behind the axis, one bit each.
    pub behind: u32,
}

/// A ball's motion about the axis: displacements by half the box, to first order, m.
struct RadialMotion<S: Simd> {
    radius: f32x16<S>,
    /// Displacements away from the axis, and (in the next field) upwards, along each of the two axes.
    outward: [f32x16<S>; 2],
    upward: [f32x16<S>; 2],
    /// Sums over the two axes: away from the axis, and across.
    outward_sum: f32x16<S>,
    across_sum: f32x16<S>,
}

impl<S: Simd> RadialMotion<S> {
    #[inline(always)]
    fn new(simd: S, place: &GroupPlace) -> Self {
        let p = place.centres.load(simd);
        let radius = p.1.mul_add(p.1, p.0 * p.0).sqrt();
        let is_off = radius.simd_gt(splat(simd, LEAST_RADIUS_M));
        let cos = is_off.select(p.0 / radius, splat(simd, 1.0));
        let sin = is_off.select(p.1 / radius, splat(simd, 0.0));
        let [a, b] = [place.along[0].load(simd), place.along[1].load(simd)];
        let outward = [cos * a.0 + sin * a.1, cos * b.0 + sin * b.1];
        let across = [cos * a.1 - sin * a.0, cos * b.1 - sin * b.0];
        Self {
            radius,
            outward,
            upward: [a.2, b.2],
            outward_sum: outward[0].abs() + outward[1].abs(),
            across_sum: across[0].abs() + across[1].abs(),
        }
    }
}

/// Finds the balls that are near the ring, and those that touch it; `stays` is their motion during which the contact
/// must last.
#[inline(always)]
pub(super) fn ring_contact<S: Simd>(
    simd: S,
    group: &CoverGroup,
    place: &GroupPlace,
    motion: &GroupMotion,
    stays: Option<&Row>,
    ring: &RingSection,
) -> RingContact {
    let zero = splat(simd, 0.0);
    let z = place.centres.0[2].load(simd);
    let moved = RadialMotion::new(simd, place);
    let [near, far, low, high] = [ring.near, ring.far, ring.low, ring.high].map(|v| splat(simd, v));
    let out = moved.radius - moved.radius.max(near).min(far);
    let up = z - z.max(low).min(high);
    let squared = out * out + up * up;
    let radii = group.radii.load(simd);
    let reach = radii + splat(simd, ring.rounding);
    let reached = reach + motion.paths.load(simd);
    let mut result =
        RingContact { near: group.lanes & !(squared.simd_gt(reached * reached).to_bitmask() as u32), contact: 0 };
    if result.near == 0 {
        return result;
    }
    let distance = squared.sqrt();
    let mut needed = distance * (reach + motion.curvatures.load(simd));
    needed += (out * moved.outward[0] + up * moved.upward[0]).abs();
    needed += (out * moved.outward[1] + up * moved.upward[1]).abs();
    // Between ring and axis, a motion across also leads outwards.
    let least = moved.radius - moved.outward_sum;
    let bend = (least * least + moved.across_sum * moved.across_sum).sqrt() - least;
    needed += (zero - out).max(zero) * bend;
    result.near &= !(squared.simd_gt(needed).to_bitmask() as u32);
    if let Some(stays) = stays {
        let depth = (near - moved.radius).max(moved.radius - far).max((low - z).max(z - high)).min(zero);
        let gap = distance + depth + stays.load(simd) + splat(simd, ring.rounding);
        result.contact = group.lanes & (gap.simd_le(radii).to_bitmask() as u32);
    }
    result
}

/// The angles that balls cover in the whole box, except where they are nearer to the axis than the ring.
#[inline(always)]
pub(super) fn covered_angles<S: Simd>(
    simd: S,
    group: &CoverGroup,
    place: &GroupPlace,
    motion: &GroupMotion,
    ring: &RingSection,
) -> CoveredAngles {
    let p = place.centres.load(simd);
    let moved = RadialMotion::new(simd, place);
    let radius = group.radii.load(simd) + motion.curvatures.load(simd) + splat(simd, ring.rounding);
    let near = splat(simd, ring.near);
    // The centre turns by the motion across, and the ball around it covers the angle of its tangents. Nearer to the
    // axis than the ring, it covers at most the angle of a ball at the ring.
    let least = moved.radius - moved.outward_sum;
    let turn = moved.across_sum / least.max(splat(simd, LEAST_RADIUS_M));
    let turning = angle_of_tangents(simd, radius, near.max(least)) + turn;
    let pi = splat(simd, std::f32::consts::PI);
    let turning = least.simd_gt(splat(simd, LEAST_RADIUS_M)).select(turning, pi);
    // Alternatively, a larger ball covers the whole motion.
    let across = moved.across_sum;
    let larger = radius + (moved.outward_sum * moved.outward_sum + across * across).sqrt();
    let half = turning.min(angle_of_tangents(simd, larger, near.max(moved.radius))).min(pi) + splat(simd, ANGLE_ERROR);
    let behind = p.0.simd_lt(splat(simd, 0.0));
    let angle = atan2(simd, behind.select(splat(simd, 0.0) - p.1, p.1), p.0.abs());
    CoveredAngles {
        low: (angle - half).to_array(),
        high: (angle + half).to_array(),
        behind: behind.to_bitmask() as u32,
    }
}

/// An upper bound of the angle between a ball's centre and its tangents, seen from a distance; half a turn if seen from
/// inside.
#[inline(always)]
fn angle_of_tangents<S: Simd>(simd: S, radius: f32x16<S>, distance: f32x16<S>) -> f32x16<S> {
    let sine = radius / distance.max(splat(simd, LEAST_RADIUS_M));
    let square = sine * sine;
    // asin x ≤ x + x³/6 + (π/2 − 7/6) x⁵ on 0..1.
    let series = sine * (splat(simd, 1.0) + square * (splat(simd, 0.166_666_7) + square * splat(simd, 0.404_131)));
    sine.simd_lt(splat(simd, 1.0)).select(series, splat(simd, std::f32::consts::PI))
}
