//! What of a convex core is flat: the corner, edge or face that it shows in a direction.

use std::f64::consts::FRAC_PI_4;

use elbowroom_spatial::Vec3;

use super::core::Core;
use crate::patch::Wide;
use crate::{ConvexHull, Cuboid, Cylinder};

/// Radius about a middle; `None` for a point.
pub(super) fn ball(core: &Core) -> Option<(f64, Vec3)> {
    match core {
        Core::Segment(half) => Some((*half, Vec3::ZERO)),
        Core::Cylinder(c) => Some((c.half_length.hypot(c.radius), Vec3::ZERO)),
        Core::Cuboid(c) => Some((c.half_extents.length(), Vec3::ZERO)),
        Core::Hull(h) => Some((0.5 * h.aabb().extent().length(), h.aabb().center())),
        Core::Point | Core::Points(_) | Core::Triangle(_) => None,
    }
}

/// True where nothing of the core but what surrounds one point lies less than `depth` (m) behind `top`, the farthest point
/// along a unit vector. Much faster than [`wide`].
#[inline]
pub(super) fn is_corner(core: &Core, along: Vec3, top: Vec3, depth: f64) -> bool {
    let d = along.abs();
    match core {
        Core::Segment(half) => 2.0 * half * d.z > depth,
        Core::Cylinder(c) => 2.0 * (c.half_length * d.z).min(c.radius * d.x.hypot(d.y)) > depth,
        Core::Cuboid(c) => {
            let h = c.half_extents;
            2.0 * (h.x * d.x).min(h.y * d.y).min(h.z * d.z) > depth
        }
        Core::Hull(h) => {
            let least = top.dot(along) - depth;
            h.vertices().iter().filter(|v| v.dot(along) > least).count() < 2
        }
        _ => true,
    }
}

/// What lies within the grain of the farthest point along a unit vector.
pub(super) fn wide(core: &Core, along: Vec3, grain: f64, small: f64) -> Wide {
    match core {
        Core::Segment(half) => line(*half, along.z, 0.0, grain, small),
        Core::Cylinder(c) => {
            if c.radius > small && along.x.hypot(along.y) * small < grain {
                return Wide::Face;
            }
            // As wide as the round side is flat.
            line(c.half_length, along.z, (8.0 * c.radius * grain).sqrt(), grain, small)
        }
        Core::Cuboid(c) => wide_of_box(c, along, grain, small),
        Core::Hull(h) => Wide::of(h.vertices().iter().copied(), h.support(along), along, grain, small),
        _ => Wide::Point,
    }
}

/// A line along z of this half length.
fn line(half: f64, slope: f64, width: f64, grain: f64, small: f64) -> Wide {
    if 2.0 * half > small && slope.abs() * small < grain { Wide::Edge(Vec3::Z, width) } else { Wide::Point }
}

/// The axes of a box that lie across the direction.
fn wide_of_box(c: &Cuboid, along: Vec3, grain: f64, small: f64) -> Wide {
    let (mut found, mut width) = (Wide::Point, 0.0_f64);
    for k in 0..3 {
        let (length, slope) = (2.0 * c.half_extents[k], along[k].abs());
        if length > small && slope * small < grain {
            let axis = [Vec3::X, Vec3::Y, Vec3::Z][k];
            found = if matches!(found, Wide::Point) { Wide::Edge(axis, 0.0) } else { return Wide::Face };
        } else {
            width = width.max(length.min(grain / slope));
        }
    }
    if let Wide::Edge(axis, _) = found { Wide::Edge(axis, width) } else { found }
}

/// Normal of the face that looks along the direction most; of a cylinder's side the one toward `other`, the middle of what
/// it is seen by: of two round sides the points themselves say less.
pub(super) fn normal(core: &Core, along: Vec3, other: Vec3) -> Vec3 {
    match core {
        Core::Cylinder(_) if shows_end(along) => Vec3::Z * along.z.signum(),
        Core::Cylinder(_) => Vec3::new(other.x, other.y, 0.0).try_normalize().unwrap_or(along),
        Core::Cuboid(_) => {
            let axis = face_axis(along);
            [Vec3::X, Vec3::Y, Vec3::Z][axis] * along[axis].signum()
        }
        Core::Hull(h) => h.most_along(along),
        _ => along,
    }
}

/// The faces that look along the direction most, as corners in order; a line has two of them. Where an edge is farthest,
/// one of its two faces is enough.
pub(super) fn faces(core: &Core, along: Vec3, each: &mut dyn FnMut(&[Vec3])) {
    match core {
        Core::Segment(half) => each(&[Vec3::Z * *half, Vec3::Z * -half]),
        Core::Cylinder(c) if shows_end(along) => each(&end(c, along.z)),
        Core::Cylinder(c) => {
            let side = Vec3::new(along.x, along.y, 0.0).try_normalize().unwrap_or(along) * c.radius;
            each(&[side + Vec3::Z * c.half_length, side - Vec3::Z * c.half_length]);
        }
        Core::Cuboid(c) => each(&side(c, along)),
        Core::Hull(h) => triangles(h, along, each),
        _ => {}
    }
}

/// The point of the core nearest to `p`, local frame.
pub(super) fn nearest(core: &Core, p: Vec3) -> Vec3 {
    match core {
        Core::Segment(half) => Vec3::Z * p.z.clamp(-half, *half),
        Core::Cylinder(c) => c.nearest(p),
        Core::Cuboid(c) => c.nearest(p),
        Core::Hull(h) => h.nearest(p),
        _ => p,
    }
}

/// True where a cylinder shows a flat end rather than its side.
fn shows_end(along: Vec3) -> bool {
    along.z.abs() > along.x.hypot(along.y)
}

/// An octagon in the flat end of a cylinder.
fn end(c: &Cylinder, toward: f64) -> [Vec3; 8] {
    std::array::from_fn(|k| {
        let (sin, cos) = (k as f64 * FRAC_PI_4).sin_cos();
        Vec3::new(c.radius * cos, c.radius * sin, c.half_length.copysign(toward))
    })
}

fn face_axis(along: Vec3) -> usize {
    let d = along.abs();
    let first = usize::from(d.y > d.x);
    if d.z > d[first] { 2 } else { first }
}

fn side(c: &Cuboid, along: Vec3) -> [Vec3; 4] {
    let k = face_axis(along);
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(u, v)| {
        let mut p = [0.0; 3];
        (p[i], p[j], p[k]) = (u * c.half_extents[i], v * c.half_extents[j], c.half_extents[k].copysign(along[k]));
        Vec3::from(p)
    })
}

/// Triangles whose normals differ by less than this from the one that looks along the direction most are one face.
const FLAT: f64 = 1e-6;

fn triangles(hull: &ConvexHull, along: Vec3, each: &mut dyn FnMut(&[Vec3])) {
    let most = hull.most_along(along);
    for (number, normal) in hull.normals().enumerate() {
        if (normal - most).length_squared() < FLAT * FLAT {
            each(&hull.corners(number));
        }
    }
}
