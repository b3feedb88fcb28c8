//! The nearest point of a surface, a function per shape in its own frame.

use elbowroom_spatial::{Pose, Vec3};

use crate::separation::{nearest_on_mesh, usable};
use crate::{Capsule, ConvexHull, Cuboid, Cylinder, Shape, TriMesh};

/// The point of a shape's surface nearest to a given point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Distance to the surface in metres, negative inside the solid. Never negative for an open mesh.
    pub signed_distance: f64,
    /// Nearest point of the surface, in the world.
    pub on_surface: Vec3,
    /// Unit vector in the world along which the signed distance grows fastest: the outward normal there.
    pub outward: Vec3,
}

/// Nearest surface point and signed distance of the world point `p`.
///
/// Exact to a few units in the last place. Where several surface points are equally near (the centre of a sphere, the
/// axis of a cylinder), one is chosen the same way each time. A NaN or an infinity gives a signed distance of 0.
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
pub fn project_point(shape: &Shape, shape_in_world: &Pose, p: Vec3) -> SurfacePoint {
    let unknown = SurfacePoint { signed_distance: 0.0, on_surface: shape_in_world.translation, outward: Vec3::Z };
    if !(p.is_finite() && usable(shape, shape_in_world)) {
        return unknown;
    }
    let local = project_local(shape, shape_in_world.inverse_transform_point(p));
    if !local.signed_distance.is_finite() {
        return unknown;
    }
    SurfacePoint {
        signed_distance: local.signed_distance,
        on_surface: shape_in_world.transform_point(local.on_surface),
        outward: shape_in_world.transform_vector(local.outward),
    }
}

fn project_local(shape: &Shape, p: Vec3) -> SurfacePoint {
    match shape {
        Shape::Sphere(s) => around(p, Vec3::ZERO, s.radius, Vec3::Z),
        Shape::Capsule(c) => capsule(c, p),
        Shape::Cylinder(c) => cylinder(c, p),
        Shape::Cuboid(c) => cuboid(c, p),
        Shape::HalfSpace(_) => {
            SurfacePoint { signed_distance: p.z, on_surface: Vec3::new(p.x, p.y, 0.0), outward: Vec3::Z }
        }
        Shape::Hull(h) => hull(h, p),
        Shape::Mesh(m) => mesh(m, p),
    }
}

/// Surface at `radius` around `center`; `otherwise` is the direction for the centre itself.
fn around(p: Vec3, center: Vec3, radius: f64, otherwise: Vec3) -> SurfacePoint {
    let outward = (p - center).try_normalize().unwrap_or(otherwise);
    let signed_distance = (p - center).length() - radius;
    SurfacePoint { signed_distance, on_surface: center + outward * radius, outward }
}

/// `nearest` is the nearest point of a solid that does not hold `p`.
fn outside(p: Vec3, nearest: Vec3) -> Option<SurfacePoint> {
    let outward = (p - nearest).try_normalize()?;
    Some(SurfacePoint { signed_distance: (p - nearest).length(), on_surface: nearest, outward })
}

fn capsule(c: &Capsule, p: Vec3) -> SurfacePoint {
    // On the axis, the nearest surface is the side, or the cap at the very end.
    let otherwise = if c.half_length > 0.0 { Vec3::X } else { Vec3::Z };
    around(p, c.axis_point(p), c.radius, otherwise)
}

fn cylinder(c: &Cylinder, p: Vec3) -> SurfacePoint {
    if let Some(found) = outside(p, c.nearest(p)) {
        return found;
    }
    let rho = p.x.hypot(p.y);
    let (to_side, to_end) = (c.radius - rho, c.half_length - p.z.abs());
    if to_side < to_end {
        let outward = Vec3::new(p.x, p.y, 0.0).try_normalize().unwrap_or(Vec3::X);
        return SurfacePoint { signed_distance: -to_side, on_surface: outward * c.radius + Vec3::Z * p.z, outward };
    }
    let outward = Vec3::Z * 1.0_f64.copysign(p.z);
    let on_surface = Vec3::new(p.x, p.y, c.half_length.copysign(p.z));
    SurfacePoint { signed_distance: -to_end, on_surface, outward }
}

fn cuboid(c: &Cuboid, p: Vec3) -> SurfacePoint {
    if let Some(found) = outside(p, c.nearest(p)) {
        return found;
    }
    let depth = c.half_extents - p.abs();
    let k = (0..3).fold(0, |best, k| if depth[k] < depth[best] { k } else { best });
    let outward = [Vec3::X, Vec3::Y, Vec3::Z][k] * 1.0_f64.copysign(p[k]);
    SurfacePoint { signed_distance: -depth[k], on_surface: p + outward * depth[k], outward }
}

fn hull(h: &ConvexHull, p: Vec3) -> SurfacePoint {
    if let Some(found) = outside(p, h.nearest(p)) {
        return found;
    }
    // Inside a convex solid the nearest plane is the nearest face.
    let heights = h.planes().iter().map(|&(normal, offset)| (normal.dot(p) - offset, normal));
    let (height, outward) = heights.fold((f64::NEG_INFINITY, Vec3::Z), |best, x| if x.0 > best.0 { x } else { best });
    SurfacePoint { signed_distance: height, on_surface: p - outward * height, outward }
}

fn mesh(m: &TriMesh, p: Vec3) -> SurfacePoint {
    let (on_surface, triangle) = nearest_on_mesh(m, p);
    let [a, b, c] = m.corners(triangle);
    let normal = (b - a).cross(c - a).try_normalize().unwrap_or(Vec3::Z);
    let normal = if m.report().inside_out { -normal } else { normal };
    let distance = (p - on_surface).length();
    let away = (p - on_surface).try_normalize();
    if m.contains(p) {
        return SurfacePoint { signed_distance: -distance, on_surface, outward: away.map_or(normal, |v| -v) };
    }
    SurfacePoint { signed_distance: distance, on_surface, outward: away.unwrap_or(normal) }
}
