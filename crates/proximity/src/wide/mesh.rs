//! A mesh with its wide tree.

use std::sync::Arc;

use elbowroom_spatial::{Pose, Vec3};

use super::placement::Pairing;
use super::tree::Tree;
use crate::TriMesh;
use crate::triangle::{Near, triangle_triangle};

/// A triangle mesh ready for exact queries against others.
///
/// ```
/// use elbowroom_proximity::{TriMesh, wide::{Scratch, WideMesh, collide}};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
/// let wide = WideMesh::new(mesh.into());
/// let mut scratch = Scratch::new();
/// let (near, far) = (Pose::from_translation(Vec3::X * 0.9), Pose::from_translation(Vec3::X * 1.1));
/// assert!(collide(&wide, &Pose::IDENTITY, &wide, &near, &mut scratch).is_some());
/// assert!(collide(&wide, &Pose::IDENTITY, &wide, &far, &mut scratch).is_none());
/// ```
#[derive(Debug, Clone)]
pub struct WideMesh {
    pub(super) mesh: Arc<TriMesh>,
    pub(super) tree: Tree,
    /// Vertices that reach farthest along each axis, local frame: if one is outside a box, so is part of the mesh.
    extremes: [Vec3; 6],
}

impl WideMesh {
    /// Builds the tree on up to two threads.
    pub fn new(mesh: Arc<TriMesh>) -> Self {
        Self::with_threads(mesh, 2)
    }

    /// Builds the tree on so many threads; the tree is the same for any number.
    pub fn with_threads(mesh: Arc<TriMesh>, threads: usize) -> Self {
        let tree = Tree::build(mesh.vertices(), mesh.triangles(), threads);
        let extremes = extremes(&mesh);
        Self { mesh, tree, extremes }
    }

    /// The mesh itself.
    pub fn mesh(&self) -> &Arc<TriMesh> {
        &self.mesh
    }

    /// Bytes of the tree, beside the vertices and indices of the mesh.
    pub fn tree_bytes(&self) -> usize {
        self.tree.bytes()
    }

    /// Triangle number in a slot of the tree.
    #[inline]
    pub(super) fn triangle(&self, slot: u32) -> usize {
        self.tree.order[slot as usize] as usize
    }

    /// Corners in the tree's frame.
    #[inline]
    pub(super) fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.mesh.corners(triangle).map(|p| self.tree.frame.to_units(p))
    }
}

fn extremes(mesh: &TriMesh) -> [Vec3; 6] {
    let vertices = || mesh.triangles().iter().flatten().map(|&v| mesh.vertices()[v as usize]);
    std::array::from_fn(|n| {
        let sign = if n < 3 { -1.0 } else { 1.0 };
        vertices().fold(mesh.corners(0)[0], |best, v| if v[n % 3] * sign > best[n % 3] * sign { v } else { best })
    })
}

/// Nearest points of two triangles, robustly, in units and axes of A's tree.
pub(super) fn settle(a: &WideMesh, ta: usize, b: &WideMesh, tb: usize, pairing: &Pairing) -> Near {
    triangle_triangle(a.corners(ta), b.corners(tb).map(|p| pairing.to_a(p)))
}

/// A point of one mesh that lies inside the other (world), where the surfaces are known not to touch.
pub(super) fn swallowed(a: &WideMesh, a_in_world: &Pose, b: &WideMesh, b_in_world: &Pose) -> Option<Vec3> {
    inside(a, a_in_world, b, b_in_world).or_else(|| inside(b, b_in_world, a, a_in_world))
}

/// A point of `small` inside `large`.
fn inside(large: &WideMesh, large_in_world: &Pose, small: &WideMesh, small_in_world: &Pose) -> Option<Vec3> {
    if !large.mesh.has_inside() {
        return None;
    }
    let in_large = |p: Vec3| large_in_world.inverse_transform_point(small_in_world.transform_point(p));
    let room = large.mesh.aabb();
    // Apart surfaces: a connected mesh is inside as a whole or not at all.
    if small.mesh.parts.len() == 1 && !small.extremes.iter().all(|&p| room.contains(in_large(p))) {
        return None;
    }
    let found = small.mesh.parts.iter().find(|&&p| large.mesh.contains(in_large(p)));
    found.map(|&p| small_in_world.transform_point(p))
}
