//! The box around several shapes.

use elbowroom_proximity::{Cuboid, Shape};
use elbowroom_spatial::{Obb, Vec3};

use crate::bounding_volume::Enclosed;
use crate::local_shape::LocalShape;

/// A tight oriented box around the shapes: for one primitive, the box in its own frame. `None` if there are no points.
pub(crate) fn cuboid(exact: &[LocalShape]) -> Option<LocalShape> {
    of_primitive(exact).or_else(|| Enclosed::new(points(exact)).cuboid())
}

/// The box around one primitive, in its own frame; `None` for other shapes.
pub(crate) fn of_primitive(exact: &[LocalShape]) -> Option<LocalShape> {
    let [only] = exact else { return None };
    let half_extents = half_extents(&only.shape)?;
    Some(LocalShape::new(Shape::Cuboid(Cuboid { half_extents }), only.in_geometry))
}

/// The box around a primitive in its own frame.
fn half_extents(shape: &Shape) -> Option<Vec3> {
    match shape {
        Shape::Sphere(s) => Some(Vec3::splat(s.radius)),
        Shape::Capsule(c) => Some(Vec3::new(c.radius, c.radius, c.half_length + c.radius)),
        Shape::Cylinder(c) => Some(Vec3::new(c.radius, c.radius, c.half_length)),
        Shape::Cuboid(c) => Some(c.half_extents),
        Shape::HalfSpace(_) | Shape::Hull(_) | Shape::Mesh(_) => None,
    }
}

/// Points whose convex hull encloses the shapes.
pub(crate) fn points(shapes: &[LocalShape]) -> Vec<Vec3> {
    let mut points = Vec::new();
    for s in shapes {
        let place = |p: Vec3| s.in_geometry.transform_point(p);
        match &s.shape {
            Shape::Mesh(m) => points.extend(m.vertices().iter().map(|&p| place(p))),
            Shape::Hull(h) => points.extend(h.vertices().iter().map(|&p| place(p))),
            Shape::Cylinder(c) => points.extend(prism(c.half_length, c.radius).into_iter().map(place)),
            other => points.extend(
                half_extents(other)
                    .into_iter()
                    .flat_map(|half_extents| Obb { pose: s.in_geometry, half_extents }.corners()),
            ),
        }
    }
    points
}

/// Corners of a 24-sided prism around a cylinder along z.
fn prism(half_length: f64, radius: f64) -> Vec<Vec3> {
    let step = std::f64::consts::TAU / 24.0;
    // The corners lie outside the cylinder, so that the sides touch it; slightly enlarged for rounding.
    let out = radius / (0.5 * step).cos() * (1.0 + 1e-14);
    let corner = |i: u32| (f64::from(i) * step).sin_cos();
    (0..24).map(corner).flat_map(|(s, c)| [-1.0, 1.0].map(|z| Vec3::new(out * c, out * s, z * half_length))).collect()
}
