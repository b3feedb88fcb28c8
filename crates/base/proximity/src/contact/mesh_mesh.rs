//! Contact of two meshes: the middle of the longest crossing of two triangles.

use elbowroom_spatial::{Pose, Vec3};

use super::contact_point::ContactPoint;
use super::crossing::LongestCrossing;
use super::surface::outward_normal;
use crate::advanced::{MeshFeatures, for_each_contact};
use crate::{TriMesh, Workspace};

/// How two meshes touch.
pub(super) enum MeshContact {
    /// Their surfaces meet.
    Surfaces(ContactPoint),
    /// One is inside the other.
    Containment,
    /// A pose is not usable.
    Unknown,
}

/// The contact of two meshes; `None` if they are apart.
pub(super) fn mesh_mesh(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    workspace: &mut Workspace,
) -> Option<MeshContact> {
    let b_in_a = a_in_world.inverse_mul(b_in_world);
    let size = a.aabb().extent().max_element() + b.aabb().extent().max_element();
    let (mut longest, mut other) = (LongestCrossing::new(size), None);
    for_each_contact(a, a_in_world, b, b_in_world, workspace, |features| match features {
        MeshFeatures::Triangles(x, y) => {
            let t = b.corners(y as usize).map(|p| b_in_a.transform_point(p));
            longest.offer(a.corners(x as usize), t, (x, y));
        }
        MeshFeatures::Containment => other = Some(MeshContact::Containment),
        MeshFeatures::Unknown => other = Some(MeshContact::Unknown),
    });
    let Some(c) = longest.found() else { return other };
    let (on_a, on_b) = (a_in_world.transform_point(c.on_a), a_in_world.transform_point(c.on_b));
    let at_b = b_in_world.inverse_transform_point(on_b);
    let (x, y) = c.triangles;
    let normal_a = a_in_world.transform_vector(outward_normal(a, x as usize, c.on_a, Vec3::Z));
    let away = b_in_world.inverse_transform_vector(-normal_a);
    Some(MeshContact::Surfaces(ContactPoint {
        on_a,
        on_b,
        normal_a,
        normal_b: b_in_world.transform_vector(outward_normal(b, y as usize, at_b, away)),
        triangle_a: Some(x),
        triangle_b: Some(y),
        touching: true,
    }))
}
