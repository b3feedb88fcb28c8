//! Two convex shapes without a special method: projections, then GJK if these do not converge.

use elbowroom_spatial::{Pose, Vec3};

use super::continuous_witness::continuous_witness;
use super::core::{Core, rounded};
use super::gap::{Gap, rounding};
use super::goal::Goal;
use super::{half_space, projections};
use crate::Shape;

/// Separation data of two bounded convex shapes: the gap of the cores, in the frame of the second, and the radii.
#[inline]
pub(super) fn rounded_convex(a: &Shape, b: &Shape, a_in_b: &Pose, limit: f64, goal: Goal) -> Option<(Gap, [f64; 2])> {
    let (gap, radii) = convex(a, b, a_in_b, limit)?;
    let apart = gap.is_beyond(radii[0] + radii[1]);
    let gap = if goal.is_continuous() && apart { with_continuous_witness(a, b, a_in_b, gap) } else { gap };
    Some((gap, radii))
}

fn with_continuous_witness(a: &Shape, b: &Shape, a_in_b: &Pose, gap: Gap) -> Gap {
    match (rounded(a), rounded(b)) {
        (Some((a, _)), Some((b, _))) => continuous_witness(&a, &b, a_in_b, gap),
        _ => gap,
    }
}

/// Separation data of two convex shapes, the second possibly a half-space: the gap of the cores, in the frame of the
/// second, and the radii.
#[inline]
pub(crate) fn convex(a: &Shape, b: &Shape, a_in_b: &Pose, limit: f64) -> Option<(Gap, [f64; 2])> {
    let (core_a, ra) = rounded(a)?;
    if matches!(b, Shape::HalfSpace(_)) {
        return Some((half_space::core_half_space(&core_a, a_in_b), [ra, 0.0]));
    }
    let (core_b, rb) = rounded(b)?;
    // This limit is beyond the place where the bound in `Gap::separation` passes the limit, so that bound alone decides.
    let limit = limit + ra + rb + 2.0 * rounding(ra + rb);
    let proven = bounds_gap(&core_a, &core_b, a_in_b);
    if proven > limit {
        return None;
    }
    let gap = projections::distance(&core_a, &core_b, a_in_b, limit)?.at_least(proven);
    Some((gap, [ra, rb]))
}

/// Gap of the bounding boxes along the axes of the second's frame, which never exceeds the exact distance. 0 if it
/// is unknown.
#[allow(clippy::inline_always, reason = "for two boxes it is most of the time")]
#[inline(always)]
fn bounds_gap(a: &Core, b: &Core, a_in_b: &Pose) -> f64 {
    let half_b = match b {
        Core::Cuboid(c) => c.half_extents,
        Core::Cylinder(c) => Vec3::new(c.radius, c.radius, c.half_length),
        _ => return 0.0,
    };
    let z = a_in_b.rotation.z_axis().abs();
    let half_a = match a {
        Core::Cuboid(c) => a_in_b.rotation.abs_mul(c.half_extents),
        Core::Cylinder(c) => z * c.half_length + Vec3::splat(c.radius),
        _ => return 0.0,
    };
    let t = a_in_b.translation.abs();
    let excess = (t - half_a - half_b).max_element();
    excess - rounding(t.x + t.y + t.z + half_a.max_element() + half_b.max_element())
}
