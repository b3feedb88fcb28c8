//! All pairs of triangles of two surfaces that touch, each with its contact segment.

use std::sync::Arc;

use elbowroom_spatial::{Pose, Vec3};

use super::crossing::triangles_meet;
use crate::advanced::{MeshFeatures, for_each_contact};
use crate::tessellate::tessellate;
use crate::{Shape, TriMesh, Workspace};

/// Two triangles that touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleContact {
    /// Index of the triangle of the first mesh.
    pub triangle_a: u32,
    /// Index of the triangle of the second mesh.
    pub triangle_b: u32,
    /// The ends of the segment in which the triangles cross, in the world. If they only touch, or lie in one plane: the
    /// nearest points, the first one on the first triangle.
    pub segment: [Vec3; 2],
}

/// The surface of a shape as triangles. `None` for half-spaces, which are unbounded, and for shapes whose triangles
/// are not a valid mesh.
///
/// Meshes, hulls and boxes are exact. Spheres, capsules and cylinders are inscribed, no farther from the surface
/// than `chord_error_m` (at most 256 segments around).
///
/// ```
/// use elbowroom_proximity::contact::triangle_surface;
/// use elbowroom_proximity::{Cuboid, Shape};
/// use elbowroom_spatial::Vec3;
/// let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.1) });
/// assert_eq!(triangle_surface(&cube, 1e-4).unwrap().triangles().len(), 12);
/// ```
pub fn triangle_surface(shape: &Shape, chord_error_m: f64) -> Option<Arc<TriMesh>> {
    match shape {
        Shape::Mesh(mesh) => Some(Arc::clone(mesh)),
        Shape::HalfSpace(_) => None,
        _ => {
            let (vertices, triangles) = tessellate(shape, chord_error_m);
            TriMesh::new(vertices, triangles).ok().map(Arc::new)
        }
    }
}

/// Calls `found` for each pair of triangles that touch, or that are closer than f64 can separate, once per pair and
/// in no particular order.
///
/// Returns true if the meshes are in contact without touching triangles: one is inside the other, or a pose is not
/// usable.
///
/// ```
/// use elbowroom_proximity::contact::for_each_triangle_contact;
/// use elbowroom_proximity::{TriMesh, Workspace};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let there = Pose::from_translation(Vec3::new(0.3, 0.3, -0.5));
/// let mut contacts = Vec::new();
/// for_each_triangle_contact(&mesh, &Pose::IDENTITY, &mesh, &there, &mut Workspace::new(), |c| contacts.push(c));
/// // The tip of the second mesh passes through the bottom face (z = 0) of the first.
/// let bottom = contacts.iter().filter(|c| c.triangle_a == 0);
/// assert!(bottom.clone().count() > 0 && bottom.flat_map(|c| c.segment).all(|p| p.z.abs() < 1e-12));
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn for_each_triangle_contact(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    workspace: &mut Workspace,
    mut found: impl FnMut(TriangleContact),
) -> bool {
    let b_in_a = a_in_world.inverse_mul(b_in_world);
    let mut without_triangles = false;
    for_each_contact(a, a_in_world, b, b_in_world, workspace, |features| match features {
        MeshFeatures::Triangles(x, y) => {
            let t = b.corners(y as usize).map(|p| b_in_a.transform_point(p));
            let (p, q) = triangles_meet(&a.corners(x as usize), &t);
            let segment = [p, q].map(|p| a_in_world.transform_point(p));
            found(TriangleContact { triangle_a: x, triangle_b: y, segment });
        }
        MeshFeatures::Containment | MeshFeatures::Unknown => without_triangles = true,
    });
    without_triangles
}
