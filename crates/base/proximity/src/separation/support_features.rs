//! The corner, edge or face of a convex core in a direction.

use std::f64::consts::FRAC_PI_4;

use elbowroom_spatial::Vec3;

use super::core::Core;
use crate::witness_patch::{PatchTolerances, SupportFeature};
use crate::{ConvexHull, Cuboid, Cylinder};

/// Radius and centre of a bounding sphere; `None` for a point.
pub(super) fn bounding_sphere(core: &Core) -> Option<(f64, Vec3)> {
    match core {
        Core::Segment(half) => Some((*half, Vec3::ZERO)),
        Core::Cylinder(c) => Some((c.half_length.hypot(c.radius), Vec3::ZERO)),
        Core::Cuboid(c) => Some((c.half_extents.length(), Vec3::ZERO)),
        Core::Hull(h) => Some((0.5 * h.aabb().extent().length(), h.aabb().center())),
        Core::Point | Core::Points(_) | Core::Triangle(_) => None,
    }
}

/// True if, within `depth` (m) of the height of `top`, the core has only the neighbourhood of one point. `top` is
/// the support point along a unit vector. Much faster than [`support_feature`].
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

/// The feature within the tie tolerance of the support point along a unit vector.
pub(super) fn support_feature(core: &Core, along: Vec3, tolerances: PatchTolerances) -> SupportFeature {
    let PatchTolerances { tie, min_size } = tolerances;
    match core {
        Core::Segment(half) => line(*half, along.z, 0.0, tolerances),
        Core::Cylinder(c) => {
            if c.radius > min_size && along.x.hypot(along.y) * min_size < tie {
                return SupportFeature::Face;
            }
            // The width within which the lateral surface is within the tolerance.
            line(c.half_length, along.z, (8.0 * c.radius * tie).sqrt(), tolerances)
        }
        Core::Cuboid(c) => box_feature(c, along, tolerances),
        Core::Hull(h) => SupportFeature::of(h.vertices().iter().copied(), h.support(along), along, tolerances),
        _ => SupportFeature::Point,
    }
}

/// The feature of a line along z with this half length.
fn line(half: f64, slope: f64, width: f64, tolerances: PatchTolerances) -> SupportFeature {
    let PatchTolerances { tie, min_size } = tolerances;
    let is_edge = 2.0 * half > min_size && slope.abs() * min_size < tie;
    if is_edge { SupportFeature::Edge(Vec3::Z, width) } else { SupportFeature::Point }
}

/// The feature of a box, by its axes that are perpendicular to the direction.
fn box_feature(c: &Cuboid, along: Vec3, tolerances: PatchTolerances) -> SupportFeature {
    let PatchTolerances { tie, min_size } = tolerances;
    let (mut found, mut width) = (SupportFeature::Point, 0.0_f64);
    for k in 0..3 {
        let (length, slope) = (2.0 * c.half_extents[k], along[k].abs());
        if length > min_size && slope * min_size < tie {
            let axis = [Vec3::X, Vec3::Y, Vec3::Z][k];
            let SupportFeature::Point = found else { return SupportFeature::Face };
            found = SupportFeature::Edge(axis, 0.0);
        } else {
            width = width.max(length.min(tie / slope));
        }
    }
    if let SupportFeature::Edge(axis, _) = found { SupportFeature::Edge(axis, width) } else { found }
}

/// Normal of the face most aligned with the direction. For a cylinder's lateral surface it is the normal towards
/// `other`, the centre of the other shape, which is more accurate than the closest points of two lateral surfaces.
pub(super) fn normal(core: &Core, along: Vec3, other: Vec3) -> Vec3 {
    match core {
        Core::Cylinder(_) if faces_end(along) => Vec3::Z * along.z.signum(),
        Core::Cylinder(_) => Vec3::new(other.x, other.y, 0.0).try_normalize().unwrap_or(along),
        Core::Cuboid(_) => {
            let axis = face_axis(along);
            [Vec3::X, Vec3::Y, Vec3::Z][axis] * along[axis].signum()
        }
        Core::Hull(h) => h.most_aligned_normal(along),
        _ => along,
    }
}

/// Calls `each` with the faces most aligned with the direction, as corners in order; a line has two corners. If an
/// edge is the support feature, one of its two faces is sufficient.
pub(super) fn for_each_face(core: &Core, along: Vec3, each: &mut dyn FnMut(&[Vec3])) {
    match core {
        Core::Segment(half) => each(&[Vec3::Z * *half, Vec3::Z * -half]),
        Core::Cylinder(c) if faces_end(along) => each(&end(c, along.z)),
        Core::Cylinder(c) => {
            let side = Vec3::new(along.x, along.y, 0.0).try_normalize().unwrap_or(along) * c.radius;
            each(&[side + Vec3::Z * c.half_length, side - Vec3::Z * c.half_length]);
        }
        Core::Cuboid(c) => each(&box_face(c, along)),
        Core::Hull(h) => for_each_hull_face(h, along, each),
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

/// True if the face of a cylinder is an end rather than its lateral surface.
fn faces_end(along: Vec3) -> bool {
    along.z.abs() > along.x.hypot(along.y)
}

/// An octagon in one end of a cylinder.
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

fn box_face(c: &Cuboid, along: Vec3) -> [Vec3; 4] {
    let k = face_axis(along);
    let (i, j) = ((k + 1) % 3, (k + 2) % 3);
    [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(u, v)| {
        let mut p = [0.0; 3];
        (p[i], p[j], p[k]) = (u * c.half_extents[i], v * c.half_extents[j], c.half_extents[k].copysign(along[k]));
        Vec3::from(p)
    })
}

/// Largest difference of normals from the most aligned one at which triangles count as one face.
const COPLANAR: f64 = 1e-6;

fn for_each_hull_face(hull: &ConvexHull, along: Vec3, each: &mut dyn FnMut(&[Vec3])) {
    let aligned = hull.most_aligned_normal(along);
    for (number, normal) in hull.normals().enumerate() {
        if (normal - aligned).length_squared() < COPLANAR * COPLANAR {
            each(&hull.corners(number));
        }
    }
}
