//! Projection of a point onto a surface: one function per shape, in the shape's frame.

use elbowroom_spatial::{Pose, Vec3};

use crate::separation::{nearest_on_mesh, nearest_on_mesh_within};
use crate::{Capsule, ConvexHull, Cuboid, Cylinder, Shape, TriMesh};

/// The point of a shape's surface nearest to a given point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointProjection {
    /// Distance to the surface in metres, negative inside the solid. Never negative for an open mesh.
    pub signed_distance: f64,
    /// Nearest point of the surface, in the world.
    pub on_surface: Vec3,
    /// Unit vector in the world along which the signed distance grows fastest: the outward normal at `on_surface`.
    pub outward: Vec3,
}

/// Nearest surface point and signed distance of the world point `p`.
///
/// Exact to a few units in the last place. If several surface points are equally near (at the centre of a sphere, on
/// the axis of a cylinder), the choice is deterministic. A NaN or an infinity gives a signed distance of 0.
///
/// ```
/// use elbowroom_proximity::{Cylinder, Shape, project_point};
/// use elbowroom_spatial::{Pose, Vec3};
/// let column = Shape::Cylinder(Cylinder { half_length: 0.6, radius: 0.15 });
/// let outside = project_point(&column, &Pose::IDENTITY, Vec3::new(0.45, 0.0, 1.0)); // off the rim: hypot(0.3, 0.4)
/// assert!((outside.signed_distance - 0.5).abs() < 1e-15);
/// let inside = project_point(&column, &Pose::IDENTITY, Vec3::new(0.1, 0.0, 0.0));
/// assert!((inside.signed_distance + 0.05).abs() < 1e-15 && inside.outward == Vec3::X);
/// ```
pub fn project_point(shape: &Shape, shape_in_world: &Pose, p: Vec3) -> PointProjection {
    let unknown = PointProjection { signed_distance: 0.0, on_surface: shape_in_world.translation, outward: Vec3::Z };
    if !(p.is_finite() && shape.is_usable(shape_in_world)) {
        return unknown;
    }
    let local = project_local(shape, shape_in_world.inverse_transform_point(p));
    if !local.signed_distance.is_finite() {
        return unknown;
    }
    PointProjection {
        signed_distance: local.signed_distance,
        on_surface: shape_in_world.transform_point(local.on_surface),
        outward: shape_in_world.transform_vector(local.outward),
    }
}

impl TriMesh {
    /// The point of the surface nearest to `p`, both in the local frame; `None` if it is farther away than `limit_m`.
    ///
    /// ```
    /// use elbowroom_proximity::TriMesh;
    /// use elbowroom_spatial::Vec3;
    /// let triangle = TriMesh::new(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]])?;
    /// let below = Vec3::new(0.25, 0.25, -1.0);
    /// assert_eq!(triangle.nearest_point_within(below, f64::INFINITY), Some(Vec3::new(0.25, 0.25, 0.0)));
    /// assert_eq!(triangle.nearest_point_within(below, 0.9), None);
    /// # Ok::<(), elbowroom_proximity::MeshError>(())
    /// ```
    pub fn nearest_point_within(&self, p: Vec3, limit_m: f64) -> Option<Vec3> {
        nearest_on_mesh_within(self, p, limit_m).map(|(point, _)| point)
    }
}

fn project_local(shape: &Shape, p: Vec3) -> PointProjection {
    match shape {
        Shape::Sphere(s) => sphere_around(p, Vec3::ZERO, s.radius, Vec3::Z),
        Shape::Capsule(c) => capsule(c, p),
        Shape::Cylinder(c) => cylinder(c, p),
        Shape::Cuboid(c) => cuboid(c, p),
        Shape::HalfSpace(_) => {
            PointProjection { signed_distance: p.z, on_surface: Vec3::new(p.x, p.y, 0.0), outward: Vec3::Z }
        }
        Shape::Hull(h) => hull(h, p),
        Shape::Mesh(m) => mesh(m, p),
    }
}

/// Projection onto the sphere around `center`; `fallback` is the direction for the centre itself.
fn sphere_around(p: Vec3, center: Vec3, radius: f64, fallback: Vec3) -> PointProjection {
    let outward = (p - center).try_normalize().unwrap_or(fallback);
    let signed_distance = (p - center).length() - radius;
    PointProjection { signed_distance, on_surface: center + outward * radius, outward }
}

/// Projection of a point outside a solid, whose point nearest to `p` is `nearest`; `None` if `p` is inside.
fn outside(p: Vec3, nearest: Vec3) -> Option<PointProjection> {
    let outward = (p - nearest).try_normalize()?;
    Some(PointProjection { signed_distance: (p - nearest).length(), on_surface: nearest, outward })
}

fn capsule(c: &Capsule, p: Vec3) -> PointProjection {
    // For a point on the axis, the nearest surface is the side, or the cap at the very end.
    let fallback = if c.half_length > 0.0 { Vec3::X } else { Vec3::Z };
    sphere_around(p, c.axis_point(p), c.radius, fallback)
}

fn cylinder(c: &Cylinder, p: Vec3) -> PointProjection {
    if let Some(found) = outside(p, c.nearest(p)) {
        return found;
    }
    let rho = p.x.hypot(p.y);
    let (to_side, to_end) = (c.radius - rho, c.half_length - p.z.abs());
    if to_side < to_end {
        let outward = Vec3::new(p.x, p.y, 0.0).try_normalize().unwrap_or(Vec3::X);
        return PointProjection { signed_distance: -to_side, on_surface: outward * c.radius + Vec3::Z * p.z, outward };
    }
    let outward = Vec3::Z * 1.0_f64.copysign(p.z);
    let on_surface = Vec3::new(p.x, p.y, c.half_length.copysign(p.z));
    PointProjection { signed_distance: -to_end, on_surface, outward }
}

fn cuboid(c: &Cuboid, p: Vec3) -> PointProjection {
    if let Some(found) = outside(p, c.nearest(p)) {
        return found;
    }
    let depth = c.half_extents - p.abs();
    let k = (0..3).fold(0, |best, k| if depth[k] < depth[best] { k } else { best });
    let outward = [Vec3::X, Vec3::Y, Vec3::Z][k] * 1.0_f64.copysign(p[k]);
    PointProjection { signed_distance: -depth[k], on_surface: p + outward * depth[k], outward }
}

fn hull(h: &ConvexHull, p: Vec3) -> PointProjection {
    if let Some(found) = outside(p, h.nearest(p)) {
        return found;
    }
    // Inside a convex solid the nearest plane contains the nearest face.
    let heights = h.planes().iter().map(|&(normal, offset)| (normal.dot(p) - offset, normal));
    let (height, outward) = heights.fold((f64::NEG_INFINITY, Vec3::Z), |best, x| if x.0 > best.0 { x } else { best });
    PointProjection { signed_distance: height, on_surface: p - outward * height, outward }
}

fn mesh(m: &TriMesh, p: Vec3) -> PointProjection {
    let (on_surface, triangle) = nearest_on_mesh(m, p);
    let [a, b, c] = m.corners(triangle);
    let normal = (b - a).cross(c - a).try_normalize().unwrap_or(Vec3::Z);
    let normal = if m.report().inside_out { -normal } else { normal };
    let distance = (p - on_surface).length();
    // The direction of a distance made of rounding is not one.
    let rounding = 16.0 * f64::EPSILON * (p.abs().max_element() + m.aabb().extent().max_element());
    let away = if distance > rounding { (p - on_surface).try_normalize() } else { None };
    if m.contains(p) {
        return PointProjection { signed_distance: -distance, on_surface, outward: away.map_or(normal, |v| -v) };
    }
    PointProjection { signed_distance: distance, on_surface, outward: away.unwrap_or(normal) }
}
