//! Common parts of contact queries: normals and triangles at surface points, nearest points, and containment.

use elbowroom_spatial::Vec3;

use super::contact_point::ContactPoint;
use super::placed::PlacedShape;
use crate::separation::nearest_on_mesh;
use crate::{Shape, TriMesh, project_point, separation_within};

/// Normal and triangle at a point of a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurfaceElement {
    pub normal: Vec3,
    pub triangle: Option<u32>,
}

/// The nearest points of shapes that are apart; `None` if they are farther apart than the limit.
pub(super) fn nearest_points(a: PlacedShape, b: PlacedShape, limit: f64) -> Option<ContactPoint> {
    if limit == 0.0 {
        // The shapes do not touch.
        return None;
    }
    let s = separation_within(a.shape, a.in_world, b.shape, b.in_world, limit)?;
    let (of_a, of_b) = (surface_at(a, s.on_a, s.on_b - s.on_a), surface_at(b, s.on_b, s.on_a - s.on_b));
    Some(ContactPoint {
        on_a: s.on_a,
        on_b: s.on_b,
        normal_a: of_a.normal,
        normal_b: of_b.normal,
        triangle_a: of_a.triangle,
        triangle_b: of_b.triangle,
        touching: s.distance == 0.0,
    })
}

/// The surface of a shape at a point; `out` points away from the solid.
pub(super) fn surface_at(PlacedShape { shape, in_world }: PlacedShape, on: Vec3, out: Vec3) -> SurfaceElement {
    let out = out.try_normalize().unwrap_or(Vec3::Z);
    if let Shape::Mesh(mesh) = shape {
        let at = in_world.inverse_transform_point(on);
        let (_, triangle) = nearest_on_mesh(mesh, at);
        let normal = outward_normal(mesh, triangle, at, in_world.inverse_transform_vector(out));
        return SurfaceElement { normal: in_world.transform_vector(normal), triangle: Some(triangle as u32) };
    }
    // The point is moved slightly below the surface: above it, rounding would determine the direction.
    let below = on - out * (1e-7 * (on.distance(in_world.translation) + 1e-3));
    let normal = project_point(shape, in_world, below).outward;
    // If the shape is thinner than that, the nearest surface is on the other side.
    SurfaceElement { normal: if normal.dot(out) >= 0.0 { normal } else { out }, triangle: None }
}

/// The contact of shapes whose surfaces do not touch, one inside the other: a point of the inner shape, and the
/// nearest point of the outer surface.
pub(super) fn contained(a: PlacedShape, b: PlacedShape) -> ContactPoint {
    point_inside(a, b)
        .or_else(|| point_inside(b, a).map(ContactPoint::swapped))
        .unwrap_or_else(|| ContactPoint::unknown(a.in_world, b.in_world))
}

/// A point of the first shape inside the second.
fn point_inside(a: PlacedShape, b: PlacedShape) -> Option<ContactPoint> {
    let local = match a.shape {
        Shape::Mesh(m) => m
            .component_vertices()
            .iter()
            .copied()
            .find(|&p| project_point(b.shape, b.in_world, a.in_world.transform_point(p)).signed_distance <= 0.0)?,
        shape => shape.support(Vec3::Z),
    };
    let on_a = a.in_world.transform_point(local);
    let beside = project_point(b.shape, b.in_world, on_a);
    if !(beside.signed_distance <= 0.0) {
        return None;
    }
    let of_a = surface_at(a, on_a, a.in_world.rotation.z_axis());
    let of_b = surface_at(b, beside.on_surface, beside.outward);
    Some(ContactPoint {
        on_a,
        on_b: beside.on_surface,
        normal_a: of_a.normal,
        normal_b: of_b.normal,
        triangle_a: of_a.triangle,
        triangle_b: of_b.triangle,
        touching: true,
    })
}

/// Unit normal of a triangle towards the outside of the mesh, in the mesh frame. It follows the triangle's
/// orientation, unless points beside the triangle show that the solid is on that side. For a triangle without area
/// it is `away`, or z.
pub(super) fn outward_normal(mesh: &TriMesh, triangle: usize, at: Vec3, away: Vec3) -> Vec3 {
    let [a, b, c] = mesh.corners(triangle);
    let Some(normal) = (b - a).cross(c - a).try_normalize() else { return away.try_normalize().unwrap_or(Vec3::Z) };
    let step = normal * (1e-7 * mesh.aabb().extent().max_element());
    if mesh.contains(at + step) && !mesh.contains(at - step) { -normal } else { normal }
}
