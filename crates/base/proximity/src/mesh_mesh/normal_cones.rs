//! Cones around the normals of the parts of a surface, for every node, leaf and triangle of its tree.

use std::sync::Arc;

use elbowroom_spatial::Vec3;

use super::facing_kernel::LeafPatches;
use super::nearest_directions::NearestDirections;
use super::surface_patch::{NormalCone, SurfacePatch};
use super::vertex_faces::VertexFaces;
use crate::TriMesh;
use crate::bvh::{ARITY, LEAF_SIZE};

/// Added to every half-angle, radians: several times the error of an angle computed from f32 cosines.
const ANGLE_MARGIN: f64 = 2e-3;
/// Squared ratio of height to longest edge below which a triangle has no usable normal.
const FLAT: f64 = 1e-14;

/// A mesh with cones around its normals: what [`for_each_local_minimum`](super::for_each_local_minimum) needs (Johnson
/// and Cohen, *Spatialized normal cone hierarchies*, 2001).
///
/// The cone of a part contains every outward direction in which a point of the part can be the nearest of its
/// neighbourhood: the normals of its triangles, and what lies beyond them at convex edges and corners. Parts that are open,
/// not outward, joined across a seam or beside a triangle without a usable normal have a cone of all directions, so
/// they are slower and not left out.
///
/// ```
/// use std::sync::Arc;
/// use elbowroom_proximity::{TriMesh, advanced::NormalConeHierarchy};
/// use elbowroom_spatial::Vec3;
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let cones = NormalConeHierarchy::new(Arc::new(mesh));
/// assert_eq!(cones.mesh().triangles().len(), 4);
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
#[derive(Debug, Clone)]
pub struct NormalConeHierarchy {
    mesh: Arc<TriMesh>,
    pub(super) vertex_faces: VertexFaces,
    /// The patches of the triangles of each leaf.
    leaves: Vec<LeafPatches>,
    /// Patches by height, then by number; height 0 has the leaves.
    levels: Vec<Vec<SurfacePatch>>,
}

impl NormalConeHierarchy {
    /// Computes the cones.
    pub fn new(mesh: Arc<TriMesh>) -> Self {
        let vertex_faces = VertexFaces::new(&mesh);
        let outward = outward_triangles(&mesh, &vertex_faces);
        let triangles = cones_of_triangles(&mesh, &vertex_faces, &outward);
        let patch = |&t: &u32| {
            let corners = mesh.corners(t as usize).map(|p| mesh.bvh.frame.to_units(p));
            SurfacePatch::of_triangle(corners, triangles[t as usize])
        };
        let slots: Vec<SurfacePatch> = mesh.bvh.order.iter().map(patch).collect();
        let mut levels = vec![merged(&slots, LEAF_SIZE)];
        for height in 0..mesh.bvh.height() {
            levels.push(merged(&levels[height], ARITY));
        }
        let leaves = slots.chunks(LEAF_SIZE).map(LeafPatches::new).collect();
        Self { mesh, vertex_faces, leaves, levels }
    }

    /// The mesh.
    pub fn mesh(&self) -> &Arc<TriMesh> {
        &self.mesh
    }

    #[inline(always)]
    pub(super) fn of_node(&self, height: u8, number: u32) -> &SurfacePatch {
        &self.levels[usize::from(height)][number as usize]
    }

    #[inline(always)]
    pub(super) fn of_leaf(&self, leaf: usize) -> &LeafPatches {
        &self.leaves[leaf]
    }

    /// False if the unit vector is outside the cone of the triangle in a slot of the tree.
    pub(super) fn may_contain(&self, slot: u32, direction: Vec3) -> bool {
        self.leaves[slot as usize / LEAF_SIZE].may_contain(slot as usize % LEAF_SIZE, direction)
    }
}

fn merged(patches: &[SurfacePatch], arity: usize) -> Vec<SurfacePatch> {
    patches.chunks(arity).map(SurfacePatch::around).collect()
}

/// The outward normal of every triangle; `None` if it has none.
fn normals(mesh: &TriMesh) -> Vec<Option<Vec3>> {
    let normal = |t: usize| {
        let [a, b, c] = mesh.closed_corners(t);
        let n = (b - a).cross(c - a);
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        if n.length_squared() > longest * longest * FLAT { n.try_normalize() } else { None }
    };
    (0..mesh.triangles().len()).map(normal).collect()
}

/// Whether each triangle belongs to a closed part of the surface that encloses a volume and faces out of it. The wall of a
/// cavity does not, although it faces out of the solid.
fn outward_triangles(mesh: &TriMesh, vertex_faces: &VertexFaces) -> Vec<bool> {
    let parts = vertex_faces.parts(mesh);
    let origin = mesh.aabb().center();
    let mut volumes = vec![0.0; mesh.vertices().len()];
    for (t, &part) in parts.iter().enumerate() {
        let [a, b, c] = mesh.closed_corners(t).map(|p| p - origin);
        volumes[part as usize] += a.dot(b.cross(c));
    }
    let is_oriented = |t: usize| mesh.in_closed_component[t] && mesh.in_oriented_component[t];
    parts.iter().enumerate().map(|(t, &part)| is_oriented(t) && volumes[part as usize] > 0.0).collect()
}

fn cones_of_triangles(mesh: &TriMesh, vertex_faces: &VertexFaces, outward: &[bool]) -> Vec<NormalCone> {
    let normals = normals(mesh);
    let directions = NearestDirections::new(mesh, vertex_faces, &normals);
    let cone = |t: usize| {
        let normal = normals[t].unwrap_or(Vec3::Z);
        let mut neighbours = vertex_faces.neighbours(mesh, t);
        let is_clear = |t: usize| outward[t] && normals[t].is_some() && !vertex_faces.is_welded(mesh, t);
        if !neighbours.all(is_clear) {
            return NormalCone::every_direction(normal);
        }
        NormalCone::around_equal(&directions.of_triangle(t), ANGLE_MARGIN, normal)
    };
    (0..mesh.triangles().len()).map(cone).collect()
}
