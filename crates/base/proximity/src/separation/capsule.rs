//! A capsule against a capsule, a box or a cylinder: the closest point of its axis.

use elbowroom_spatial::{Pose, Vec3};

use super::continuous_witness::{continuous_witness, is_line_ambiguous};
use super::convex::convex;
use super::core::{Core, rounded};
use super::gap::{CLOSE, Gap, rounding};
use super::goal::Goal;
use super::result::Separation;
use super::segment::{Segment, nearest_to_box, nearest_to_cylinder};
use super::sphere::closed_form;
use crate::{Capsule, Cuboid, Shape};

pub(super) fn capsule(
    c: &Capsule,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    goal: Goal,
) -> Option<Separation> {
    let axis = Segment {
        middle: b_in_world.inverse_transform_point(a_in_world.translation),
        direction: b_in_world.inverse_transform_vector(a_in_world.rotation.z_axis()),
        half: c.half_length,
    };
    let size = (a_in_world.translation.abs() + b_in_world.translation.abs()).max_element() + c.half_length;
    // The gap to a bounding box must exceed the rounding error.
    let outer = if let Shape::Capsule(o) = b { o.radius } else { 0.0 };
    let reach = limit + c.radius + 2.0 * rounding(2.0 * size + c.radius + outer);
    let (p, q, radius) = match b {
        Shape::Capsule(o) => {
            let solid = Cuboid { half_extents: Vec3::Z * o.half_length };
            if axis.misses(solid.half_extents, reach + outer) {
                return None;
            }
            let p = nearest_to_box(&axis, &solid);
            (p, o.axis_point(p), o.radius)
        }
        Shape::Cuboid(o) => {
            if axis.misses(o.half_extents, reach) {
                return None;
            }
            let p = nearest_to_box(&axis, o);
            (p, o.nearest(p), 0.0)
        }
        Shape::Cylinder(o) => {
            if axis.misses(Vec3::new(o.radius, o.radius, o.half_length), reach) {
                return None;
            }
            let p = nearest_to_cylinder(&axis, o);
            (p, o.nearest(p), 0.0)
        }
        _ => (axis.middle, axis.middle, 0.0),
    };
    let scale = size + q.abs().max_element();
    if c.radius + radius <= CLOSE * scale && (p - q).length_squared() <= (CLOSE * scale).powi(2) {
        let points = Gap { lower: 0.0, ..Gap::closed(p, q, scale) };
        let proven = axis.box_gap(core_half_extents(b)) - rounding(2.0 * size);
        return thin_capsule(c, b, a_in_world, b_in_world, points, proven);
    }
    if goal.is_continuous() && is_line_ambiguous(axis.direction, b, q - p) {
        return ambiguous_capsule(c, a_in_world, b, b_in_world, limit, Gap::closed(p, q, scale));
    }
    closed_form(p, q, scale, [c.radius, radius], limit, b_in_world)
}

/// Separation of a capsule whose axis is perpendicular to the line between the closest points.
#[cold]
fn ambiguous_capsule(
    c: &Capsule,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    limit: f64,
    gap: Gap,
) -> Option<Separation> {
    let (core, radius) = rounded(b)?;
    if gap.lower > limit + c.radius + radius + 2.0 * rounding(c.radius + radius) {
        return None;
    }
    let apart = gap.is_beyond(c.radius + radius);
    let continuous = || {
        let a_in_b = b_in_world.inverse_mul(a_in_world);
        continuous_witness(&Core::Segment(c.half_length), &core, &a_in_b, gap)
    };
    Some(if apart { continuous() } else { gap }.separation([c.radius, radius], b_in_world))
}

/// Half extents of the box around the core of a shape.
#[cold]
fn core_half_extents(shape: &Shape) -> Vec3 {
    match shape {
        Shape::Capsule(c) => Vec3::Z * c.half_length,
        Shape::Cylinder(c) => Vec3::new(c.radius, c.radius, c.half_length),
        Shape::Cuboid(c) => c.half_extents,
        _ => Vec3::splat(f64::INFINITY),
    }
}

/// Separation of a capsule with hardly any radius that is closer than the closed form resolves: the root is lost in
/// the rounding of the excess.
#[cold]
fn thin_capsule(
    c: &Capsule,
    b: &Shape,
    a_in_world: &Pose,
    b_in_world: &Pose,
    points: Gap,
    proven: f64,
) -> Option<Separation> {
    // The query has no limit, so that the answer does not depend on it. The points of the closed form are as good as any
    // others.
    let (gap, radii) = convex(&Shape::Capsule(*c), b, &b_in_world.inverse_mul(a_in_world), f64::INFINITY)?;
    let better = gap.lower > 0.0 && points.distance < gap.distance;
    let gap = if better { points.at_least(gap.lower) } else { gap };
    Some(gap.at_least(proven).separation(radii, b_in_world))
}
