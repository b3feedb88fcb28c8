//! Collision of two meshes: finds one pair of triangles that touch, or all pairs.

use elbowroom_spatial::Pose;
use fearless_simd::dispatch;

use super::containment::contained_point;
use super::cutoff::Cutoff;
use super::leaf_kernel::{LeafPair, PairMask, touching_pairs};
use super::leaf_pairs::visit_leaf_pairs;
use super::mesh_features::MeshFeatures;
use super::mesh_pair::MeshPair;
use super::node_kernel::{INTERSECTION, expand_in};
use super::node_pair::NodePair;
use super::relative_placement::{RelativePlacement, spheres_farther_than};
use super::triangle_batch::{TriangleBatch, corners_in_a, robust_closest_points};
use super::workspace::{QueryStats, Workspace};
use crate::TriMesh;
use crate::bvh::LEAF_SIZE;
use crate::triangle::triangles_cross;

/// A pair of triangles that touch, or `None` if the meshes are guaranteed to be apart.
///
/// Triangles closer than f64 can separate count as touching: 2⁻⁴⁰ of the sizes and distance of the meshes. A mesh
/// wholly inside a closed mesh is in contact. If several pairs touch, the choice is unspecified.
///
/// ```
/// use elbowroom_proximity::{TriMesh, Workspace, advanced::colliding_triangles};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let mut workspace = Workspace::new();
/// let (near, far) = (Pose::from_translation(Vec3::X * 0.9), Pose::from_translation(Vec3::X * 1.1));
/// assert!(colliding_triangles(&mesh, &Pose::IDENTITY, &mesh, &near, &mut workspace).is_some());
/// assert!(colliding_triangles(&mesh, &Pose::IDENTITY, &mesh, &far, &mut workspace).is_none());
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
#[inline]
pub fn colliding_triangles(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    workspace: &mut Workspace,
) -> Option<MeshFeatures> {
    let mut first = None;
    visit_contacts(a, a_in_world, b, b_in_world, workspace, &mut |features| {
        first = Some(features);
        true
    });
    first
}

/// Calls `found` with every pair of triangles that touch, or that are closer than f64 can separate, once per pair
/// and in no particular order.
///
/// If none touch and one mesh is inside the other, calls it with [`MeshFeatures::Containment`].
///
/// ```
/// use elbowroom_proximity::advanced::{MeshFeatures, for_each_contact};
/// use elbowroom_proximity::{TriMesh, Workspace};
/// use elbowroom_spatial::{Pose, Vec3};
/// let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
/// let mesh = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])?;
/// let mut pairs = Vec::new();
/// let there = Pose::from_translation(Vec3::new(0.3, 0.3, -0.5));
/// for_each_contact(&mesh, &Pose::IDENTITY, &mesh, &there, &mut Workspace::new(), |pair| pairs.push(pair));
/// // The tip of the second mesh passes through the bottom face of the first.
/// assert!(pairs.iter().any(|p| matches!(p, MeshFeatures::Triangles(0, _))));
/// # Ok::<(), elbowroom_proximity::MeshError>(())
/// ```
pub fn for_each_contact(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    workspace: &mut Workspace,
    mut found: impl FnMut(MeshFeatures),
) {
    visit_contacts(a, a_in_world, b, b_in_world, workspace, &mut |features| {
        found(features);
        false
    });
}

/// Visits the contacts; `found` returns true to end the query.
fn visit_contacts(
    a: &TriMesh,
    a_in_world: &Pose,
    b: &TriMesh,
    b_in_world: &Pose,
    workspace: &mut Workspace,
    found: &mut dyn FnMut(MeshFeatures) -> bool,
) {
    workspace.begin_query();
    if spheres_farther_than(&a.bvh, a_in_world, &b.bvh, b_in_world, 0.0) {
        return;
    }
    let placement = RelativePlacement::new(&a.bvh, a_in_world, &b.bvh, b_in_world);
    if !placement.is_usable() {
        found(MeshFeatures::Unknown);
        return;
    }
    let mut touching = false;
    let mut found_triangles = |x, y| {
        touching = true;
        found(MeshFeatures::Triangles(x, y))
    };
    let meshes = MeshPair { a, b, placement: &placement, simd_level: workspace.simd_level() };
    let ended = CollisionTraversal { meshes: &meshes, found: &mut found_triangles }.run(workspace);
    if workspace.stack.overflowed() {
        found(MeshFeatures::Unknown);
    } else if !ended && !touching && contained_point(a, a_in_world, b, b_in_world).is_some() {
        found(MeshFeatures::Containment);
    }
}

struct CollisionTraversal<'a> {
    meshes: &'a MeshPair<'a>,
    /// Callback with the indices of two triangles that touch; returns true to end the traversal.
    found: &'a mut dyn FnMut(u32, u32) -> bool,
}

impl CollisionTraversal<'_> {
    fn run(&mut self, workspace: &mut Workspace) -> bool {
        let meshes = self.meshes;
        let cutoff = Cutoff::new(meshes.placement.f64_error, meshes.placement);
        let Workspace { stack, batch, stats, .. } = workspace;
        batch.clear();
        // Selected once for the whole traversal, so that the kernels are inlined into it.
        let has_ended = dispatch!(meshes.simd_level, simd => visit_leaf_pairs(
            meshes,
            #[inline(always)]
            |pair, stack| expand_in::<_, INTERSECTION>(simd, meshes, pair, pair.expanded_sides(), &cutoff, stack),
            stack,
            stats,
            |_| true,
            #[inline(always)]
            |pair, stats| {
                let leaves = LeafPair { a: pair.a as usize, b: pair.b as usize };
                let left = touching_pairs(simd, meshes, leaves, &cutoff);
                !left.is_empty() && self.visit_triangles(pair, left, batch, stats)
            },
        ));
        if has_ended {
            return true;
        }
        self.measure(batch, stats)
    }

    /// Visits pairs of triangles of two leaves. Pairs that cross are found at once; the others are measured in batches.
    fn visit_triangles(
        &mut self,
        pair: &NodePair,
        left: PairMask,
        batch: &mut TriangleBatch,
        stats: &mut QueryStats,
    ) -> bool {
        let MeshPair { a, b, placement, .. } = *self.meshes;
        for (i, j) in left.lanes() {
            let (slot_a, slot_b) = (pair.a * LEAF_SIZE as u32 + i, pair.b * LEAF_SIZE as u32 + j);
            let (ta, tb) = (a.bvh.triangle(slot_a), b.bvh.triangle(slot_b));
            let (s, t) = corners_in_a(a, ta, b, tb, placement);
            stats.triangles += 1;
            if triangles_cross(s, t) {
                if (self.found)(ta as u32, tb as u32) {
                    return true;
                }
            } else if batch.push(a, slot_a, b, slot_b) && self.measure(batch, stats) {
                return true;
            }
        }
        false
    }

    /// Measures the batch.
    fn measure(&mut self, batch: &mut TriangleBatch, stats: &mut QueryStats) -> bool {
        if batch.is_empty() {
            return false;
        }
        let MeshPair { a, b, placement, simd_level } = *self.meshes;
        let (measured, len) = batch.measure(simd_level, placement);
        stats.batches += 1;
        let contact = placement.f64_error;
        for lane in 0..len {
            if measured.at_least[lane] > contact {
                continue;
            }
            let (ta, tb) = batch.triangles[lane];
            let touches = || {
                let points = robust_closest_points(a, ta as usize, b, tb as usize, placement);
                points.squared <= contact * contact
            };
            if (measured.is_certain(lane) || touches()) && (self.found)(ta, tb) {
                return true;
            }
        }
        false
    }
}
