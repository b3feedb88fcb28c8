//! Intersection of a ray with the surface of a shape.

use elbowroom_spatial::{Aabb, Pose, Vec3};

use crate::bvh::Ray;
use crate::{Shape, TriMesh};

/// The first point at which a ray meets a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// Distance from the origin of the ray, metres.
    pub distance_m: f64,
    /// The point of the surface, in the world.
    pub point: Vec3,
    /// Outward unit normal of the surface there, in the world. At an edge, the normal of one of its faces.
    pub outward: Vec3,
    /// Index of the triangle of a mesh; `None` for other shapes.
    pub triangle: Option<usize>,
}

/// Casts a ray: the first point of a shape's surface along `direction` (of any length), seen from either side.
///
/// A ray that starts inside a solid meets the surface where it leaves. `None` if the ray misses the surface, or if the
/// input is not finite or the direction has no length. The point is on the surface to a few units in the last place. A ray
/// in the plane of a triangle does not meet that triangle, but the neighbours at its edges.
///
/// ```
/// use elbowroom_proximity::{Cylinder, Shape, ray_cast};
/// use elbowroom_spatial::{Pose, Vec3};
/// let column = Shape::Cylinder(Cylinder { half_length: 0.6, radius: 0.15 });
/// let hit = ray_cast(&column, &Pose::IDENTITY, Vec3::new(1.0, 0.0, 0.2), -Vec3::X).unwrap();
/// assert!((hit.point - Vec3::new(0.15, 0.0, 0.2)).length() < 1e-15 && hit.outward == Vec3::X);
/// assert_eq!(ray_cast(&column, &Pose::IDENTITY, Vec3::new(1.0, 0.0, 0.7), -Vec3::X), None);
/// ```
pub fn ray_cast(shape: &Shape, shape_in_world: &Pose, origin: Vec3, direction: Vec3) -> Option<RayHit> {
    if !(origin.is_finite() && shape.is_usable(shape_in_world)) {
        return None;
    }
    let along = shape_in_world.inverse_transform_vector(direction.try_normalize()?);
    let from = shape_in_world.inverse_transform_point(origin);
    let local = if let Shape::Mesh(mesh) = shape {
        mesh_hit(mesh, from, along)?
    } else {
        let end = inside(shape, from, along)?.first_end()?;
        RayHit { distance_m: end.at, point: from + along * end.at, outward: end.outward, triangle: None }
    };
    Some(RayHit {
        point: shape_in_world.transform_point(local.point),
        outward: shape_in_world.transform_vector(local.outward),
        ..local
    })
}

/// Whether the straight line between two points meets a solid: its surface, or its inside.
///
/// It stops at the first triangle that is met, so it is faster than [`ray_cast`] for a line of sight. An open mesh has no
/// inside. Input that is not finite counts as met: what is unknown is not free.
///
/// ```
/// use elbowroom_proximity::{Cylinder, Shape, intersects_segment};
/// use elbowroom_spatial::{Pose, Vec3};
/// let column = Shape::Cylinder(Cylinder { half_length: 0.6, radius: 0.15 });
/// let meets = |from: Vec3, to: Vec3| intersects_segment(&column, &Pose::IDENTITY, from, to);
/// assert!(meets(-Vec3::X, Vec3::X) && meets(Vec3::ZERO, Vec3::Z * 0.1));
/// assert!(!meets(-Vec3::X, -Vec3::X * 0.2) && !meets(Vec3::Y - Vec3::X, Vec3::Y + Vec3::X));
/// ```
pub fn intersects_segment(shape: &Shape, shape_in_world: &Pose, from: Vec3, to: Vec3) -> bool {
    if !(from.is_finite() && to.is_finite() && shape.is_usable(shape_in_world)) {
        return true;
    }
    let local = shape_in_world.inverse_transform_point(from);
    let length_m = from.distance(to);
    // A point is a line of no length, in any direction.
    let along = (to - from).try_normalize().map_or(Vec3::Z, |along| shape_in_world.inverse_transform_vector(along));
    match shape {
        Shape::Mesh(mesh) => meets_triangle(mesh, local, along, length_m) || mesh.contains(local),
        _ => inside(shape, local, along).is_some_and(|s| s.enter.at <= length_m && s.leave.at >= 0.0),
    }
}

/// An end of the part of a ray inside a convex solid: its distance along the ray, and the outward normal there.
#[derive(Clone, Copy)]
struct End {
    at: f64,
    outward: Vec3,
}

/// The part of a line inside a convex solid.
#[derive(Clone, Copy)]
struct Span {
    enter: End,
    leave: End,
}

const UNBOUNDED: Span =
    Span { enter: End { at: f64::NEG_INFINITY, outward: Vec3::Z }, leave: End { at: f64::INFINITY, outward: Vec3::Z } };

impl Span {
    /// The end that a ray from 0 meets first.
    fn first_end(self) -> Option<End> {
        let first = if self.enter.at >= 0.0 { self.enter } else { self.leave };
        (first.at >= 0.0 && first.at.is_finite()).then_some(first)
    }

    /// The part in two solids.
    fn intersection(self, other: Self) -> Option<Self> {
        let enter = if self.enter.at >= other.enter.at { self.enter } else { other.enter };
        let leave = if self.leave.at <= other.leave.at { self.leave } else { other.leave };
        (enter.at <= leave.at).then_some(Self { enter, leave })
    }

    /// The part in either of two solids whose union is convex.
    fn union(self, other: Self) -> Self {
        let enter = if self.enter.at <= other.enter.at { self.enter } else { other.enter };
        let leave = if self.leave.at >= other.leave.at { self.leave } else { other.leave };
        Self { enter, leave }
    }
}

/// The part of a line inside a convex shape, in its frame; `along` is a unit vector.
fn inside(shape: &Shape, from: Vec3, along: Vec3) -> Option<Span> {
    let below = |normal: Vec3, offset: f64| below_plane(from, along, normal, offset);
    let slab = |axis: Vec3, half: f64| below(axis, half)?.intersection(below(-axis, half)?);
    let ball = |center: Vec3, radius: f64| round(from - center, along, radius);
    match shape {
        Shape::Sphere(s) => ball(Vec3::ZERO, s.radius),
        Shape::Capsule(c) => {
            let side = pillar(from, along, c.radius).and_then(|side| side.intersection(slab(Vec3::Z, c.half_length)?));
            let end = Vec3::Z * c.half_length;
            [side, ball(end, c.radius), ball(-end, c.radius)].into_iter().flatten().reduce(Span::union)
        }
        Shape::Cylinder(c) => pillar(from, along, c.radius)?.intersection(slab(Vec3::Z, c.half_length)?),
        Shape::Cuboid(c) => {
            let slab = |axis: usize| slab([Vec3::X, Vec3::Y, Vec3::Z][axis], c.half_extents[axis]);
            slab(0)?.intersection(slab(1)?)?.intersection(slab(2)?)
        }
        Shape::HalfSpace(_) => below(Vec3::Z, 0.0),
        Shape::Hull(h) => h.planes().iter().try_fold(UNBOUNDED, |span, &(n, d)| span.intersection(below(n, d)?)),
        Shape::Mesh(_) => None,
    }
}

/// The part of a line below the plane `normal · p = offset`.
fn below_plane(from: Vec3, along: Vec3, normal: Vec3, offset: f64) -> Option<Span> {
    let (speed, height) = (normal.dot(along), normal.dot(from) - offset);
    let end = End { at: -height / speed, outward: normal };
    if speed < 0.0 {
        Some(Span { enter: end, ..UNBOUNDED })
    } else if speed > 0.0 {
        Some(Span { leave: end, ..UNBOUNDED })
    } else {
        (height <= 0.0).then_some(UNBOUNDED)
    }
}

/// The part of a line inside a ball, or in two dimensions a disc, around the origin.
fn round(from: Vec3, along: Vec3, radius: f64) -> Option<Span> {
    // From the point of the line nearest to the centre: the difference of large squares would lose digits.
    let middle = -from.dot(along);
    let nearest = from + along * middle;
    let half = ((radius - nearest.length()) * (radius + nearest.length())).max(-1.0);
    if half < 0.0 {
        return None;
    }
    let half = half.sqrt();
    let end = |at: f64, offset: f64| {
        let outward = (nearest + along * offset).try_normalize().unwrap_or(along * 1.0_f64.copysign(offset));
        End { at, outward }
    };
    Some(Span { enter: end(middle - half, -half), leave: end(middle + half, half) })
}

/// The part of a line inside an endless cylinder around the z axis.
fn pillar(from: Vec3, along: Vec3, radius: f64) -> Option<Span> {
    let flat = |v: Vec3| Vec3::new(v.x, v.y, 0.0);
    let (from, along) = (flat(from), flat(along));
    let speed = along.length();
    let Some(direction) = along.try_normalize() else {
        return (from.length() <= radius).then_some(UNBOUNDED);
    };
    let scaled = |end: End| End { at: end.at / speed, ..end };
    round(from, direction, radius).map(|s| Span { enter: scaled(s.enter), leave: scaled(s.leave) })
}

/// Border that a triangle is enlarged by, relative to its edges: a ray does not pass between two triangles that share one.
const BAND: f64 = 1e-12;
/// Least component of the direction with which the tree is searched: its boxes are inflated by more than this changes.
const LEAST_COMPONENT: f64 = 1e-9;

/// The search of the tree of a mesh along a ray, and the distance at which the ray enters the box of the mesh; `None` if
/// it misses the box.
fn searched(mesh: &TriMesh, from: Vec3, along: Vec3) -> Option<(Ray, f64)> {
    // The tree is searched in single precision, from a point of the box.
    let entered = box_entry(mesh.aabb(), from, along)?;
    let direction =
        Vec3::from(along.to_array().map(|x| if x.abs() < LEAST_COMPONENT { LEAST_COMPONENT.copysign(x) } else { x }));
    Some((Ray::new(&mesh.bvh, from + along * entered, direction), entered))
}

/// Whether a triangle of a mesh is on the first `length_m` of a ray, in the frame of the mesh.
fn meets_triangle(mesh: &TriMesh, from: Vec3, along: Vec3, length_m: f64) -> bool {
    let Some((ray, _)) = searched(mesh, from, along).filter(|(_, entered)| *entered <= length_m) else { return false };
    let mut is_met = false;
    mesh.bvh.traverse(&ray, 0.0, &mut |triangle| {
        is_met = is_met || triangle_hit(mesh, triangle, from, along).is_some_and(|hit| hit.distance_m <= length_m);
        // Nothing more is visited after the first one.
        if is_met { f32::NEG_INFINITY } else { 0.0 }
    });
    is_met
}

/// The first triangle of a mesh on a ray, in the frame of the mesh.
fn mesh_hit(mesh: &TriMesh, from: Vec3, along: Vec3) -> Option<RayHit> {
    let (ray, _) = searched(mesh, from, along)?;
    let mut first: Option<RayHit> = None;
    mesh.bvh.traverse(&ray, 0.0, &mut |triangle| {
        let found = triangle_hit(mesh, triangle, from, along);
        let is_first = |hit: &RayHit| {
            // Of two triangles at an edge, the one of the lower number, whatever the order of the tree.
            first.is_none_or(|f| (hit.distance_m, hit.triangle) < (f.distance_m, f.triangle))
        };
        first = found.filter(is_first).or(first);
        0.0
    });
    first
}

/// Distance at which a ray enters a box, 0 inside; `None` if it misses the box by more than rounding.
fn box_entry(bounds: &Aabb, from: Vec3, along: Vec3) -> Option<f64> {
    let margin = 1e-9 * (bounds.extent().max_element() + (from - bounds.center()).length());
    let (mut near, mut far) = (0.0_f64, f64::INFINITY);
    for k in 0..3 {
        let (low, high) = (bounds.min[k] - margin - from[k], bounds.max[k] + margin - from[k]);
        if along[k] == 0.0 {
            if low > 0.0 || high < 0.0 {
                return None;
            }
            continue;
        }
        let (a, b) = (low / along[k], high / along[k]);
        (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
    }
    (near <= far).then_some(near)
}

/// Where a ray meets a triangle, after Möller and Trumbore (1997).
fn triangle_hit(mesh: &TriMesh, triangle: usize, from: Vec3, along: Vec3) -> Option<RayHit> {
    let [a, b, c] = mesh.corners(triangle);
    let (e1, e2) = (b - a, c - a);
    let q = along.cross(e2);
    let det = e1.dot(q);
    let normal = e1.cross(e2).try_normalize()?;
    if det.abs() <= 1e-14 * e1.length() * e2.length() {
        return None;
    }
    let offset = from - a;
    let r = offset.cross(e1);
    let (u, v, distance_m) = (offset.dot(q) / det, along.dot(r) / det, e2.dot(r) / det);
    // The band grows with the distance, as rounding does.
    let band = BAND * (1.0 + offset.length() * (e1.length() + e2.length()) / det.abs());
    if u.min(v).min(1.0 - u - v) < -band || distance_m < 0.0 {
        return None;
    }
    // From the corners rather than along the ray: exact to the rounding of the triangle's own coordinates.
    let (u, v) = (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0));
    let excess = (u + v).max(1.0);
    let outward = if mesh.report().inside_out { -normal } else { normal };
    Some(RayHit { distance_m, point: a + e1 * (u / excess) + e2 * (v / excess), outward, triangle: Some(triangle) })
}
