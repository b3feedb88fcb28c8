//! The choice of the method for a pair of shapes.

use elbowroom_spatial::{Pose, Vec3};

use super::contact_point::{ContactPoint, ContactSettings, Detail};
use super::convex_convex::convex_convex;
use super::mesh_mesh::{MeshContact, mesh_mesh};
use super::mesh_polyhedron::mesh_polyhedron;
use super::mesh_smooth::mesh_smooth;
use super::placed::PlacedShape;
use super::surface::{contained, nearest_points};
use crate::advanced::{BvhBound, bvh_lower_bound, bvh_lower_bound_to_shape};
use crate::{QueryStats, Shape, TriMesh, Workspace};

/// The point where two shapes touch, or where they are nearest; `None` if they are guaranteed to be farther apart
/// than the limit.
///
/// If a number of a pose or a dimension is not finite, the shapes count as touching, and the points are the origins.
/// Allocates only for hulls (except boxes, cylinders and hulls against each other). All pairs of triangles that
/// touch are compared, so deep overlaps of fine meshes are slow.
///
/// At [`Detail::Boxes`] meshes are as large as their boxes at that depth: `None` is guaranteed, a reported contact
/// may be a false positive. The points are then landmarks, which are points of the surfaces (to f32 rounding) within
/// the nearest boxes; the normals are the mean normals there, and the triangles are `None`. Simple shapes have only
/// the box around the whole shape; against each other, and against half-spaces, they are measured exactly.
///
/// ```
/// use elbowroom_proximity::contact::{ContactSettings, contact_point};
/// use elbowroom_proximity::{Cuboid, Shape, TriMesh, Workspace};
/// use elbowroom_spatial::{Pose, Vec3};
/// use std::sync::Arc;
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let wedge = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let wedge = Shape::Mesh(Arc::new(wedge));
/// let table = Shape::Cuboid(Cuboid { half_extents: Vec3::new(2.0, 2.0, 0.1) });
/// let (in_the_table, settings) = (Pose::from_translation(Vec3::Z * 0.09), ContactSettings::default());
/// let met = contact_point(&wedge, &in_the_table, &table, &Pose::IDENTITY, settings, &mut Workspace::new()).unwrap();
/// assert!((met.on_a.z - 0.1).abs() < 1e-15 && met.on_a == met.on_b && met.normal_b == Vec3::Z);
/// assert!(met.triangle_a.is_some() && met.triangle_b.is_none());
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
///
/// ```
/// use elbowroom_proximity::contact::{ContactSettings, Detail, contact_point};
/// use elbowroom_proximity::{Cylinder, Shape, TriMesh, Workspace, tessellate::tessellate};
/// use elbowroom_spatial::{Pose, Vec3};
/// let (corners, faces) = tessellate(&Shape::Cylinder(Cylinder { half_length: 1.0, radius: 1.0 }), 0.001);
/// let post = Shape::Mesh(std::sync::Arc::new(TriMesh::new(corners, faces)?));
/// // The boxes around the posts touch, the posts do not.
/// let (here, there) = (Pose::IDENTITY, Pose::from_translation(Vec3::new(1.5, 1.5, 0.0)));
/// let touches = |detail| {
///     let settings = ContactSettings { detail, ..ContactSettings::default() };
///     contact_point(&post, &here, &post, &there, settings, &mut Workspace::new()).is_some()
/// };
/// assert_eq!([Detail::Boxes(0), Detail::Exact].map(touches), [true, false]);
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn contact_point(
    a: &Shape,
    a_in_world: &Pose,
    b: &Shape,
    b_in_world: &Pose,
    settings: ContactSettings,
    workspace: &mut Workspace,
) -> Option<ContactPoint> {
    workspace.set_stats(QueryStats::default());
    let limit = settings.usable_limit();
    let (a, b) = (PlacedShape { shape: a, in_world: a_in_world }, PlacedShape { shape: b, in_world: b_in_world });
    match settings.detail {
        Detail::Boxes(depth) => by_boxes(a, b, depth, limit, workspace),
        Detail::Exact => exact(a, b, limit, workspace),
    }
}

fn exact(a: PlacedShape, b: PlacedShape, limit: f64, workspace: &mut Workspace) -> Option<ContactPoint> {
    if !(a.shape.is_usable(a.in_world) && b.shape.is_usable(b.in_world)) {
        return Some(ContactPoint::unknown(a.in_world, b.in_world));
    }
    match (a.shape, b.shape) {
        (Shape::Mesh(m), Shape::Mesh(n)) => match mesh_mesh(m, a.in_world, n, b.in_world, workspace) {
            Some(MeshContact::Surfaces(point)) => Some(point),
            Some(MeshContact::Containment) => Some(contained(a, b)),
            Some(MeshContact::Unknown) => Some(ContactPoint::unknown(a.in_world, b.in_world)),
            None => nearest_points(a, b, limit),
        },
        (Shape::Mesh(m), _) => mesh_simple(m, a, b, limit, workspace),
        (_, Shape::Mesh(n)) => mesh_simple(n, b, a, limit, workspace).map(ContactPoint::swapped),
        _ => convex_convex(a, b, limit),
    }
}

/// The contact of a mesh (the first shape) and a shape that is not a mesh.
fn mesh_simple(
    mesh: &TriMesh,
    a: PlacedShape,
    b: PlacedShape,
    limit: f64,
    workspace: &mut Workspace,
) -> Option<ContactPoint> {
    if !workspace.collides(a.shape, a.in_world, b.shape, b.in_world) {
        return nearest_points(a, b, limit);
    }
    let b_in_mesh = a.in_world.inverse_mul(b.in_world);
    let found = match b.shape {
        Shape::Cuboid(_) | Shape::Hull(_) => mesh_polyhedron(mesh, a.in_world, b.shape, &b_in_mesh),
        _ => mesh_smooth(mesh, a.in_world, b.shape, &b_in_mesh),
    };
    Some(found.unwrap_or_else(|| contained(a, b)))
}

fn by_boxes(a: PlacedShape, b: PlacedShape, depth: u8, limit: f64, workspace: &mut Workspace) -> Option<ContactPoint> {
    let bound = match (a.shape, b.shape) {
        (Shape::Mesh(m), Shape::Mesh(n)) => bvh_lower_bound(m, a.in_world, n, b.in_world, depth, limit, workspace)?,
        (Shape::Mesh(m), _) => match bvh_lower_bound_to_shape(m, a.in_world, b.shape, b.in_world, depth) {
            Some(bound) => bound,
            None => return exact(a, b, limit, workspace),
        },
        (_, Shape::Mesh(_)) => return by_boxes(b, a, depth, limit, workspace).map(ContactPoint::swapped),
        _ => return exact(a, b, limit, workspace),
    };
    (!(bound.lower_bound > limit)).then(|| of_boxes(&bound))
}

/// The contact of boxes. If a mean normal is zero, the direction from one point to the other is used instead.
fn of_boxes(bound: &BvhBound) -> ContactPoint {
    let toward = (bound.on_b - bound.on_a).try_normalize().unwrap_or(Vec3::Z);
    let or = |normal: Vec3, other| if normal == Vec3::ZERO { other } else { normal };
    ContactPoint {
        on_a: bound.on_a,
        on_b: bound.on_b,
        normal_a: or(bound.normal_a, toward),
        normal_b: or(bound.normal_b, -toward),
        triangle_a: None,
        triangle_b: None,
        touching: bound.lower_bound == 0.0,
    }
}
