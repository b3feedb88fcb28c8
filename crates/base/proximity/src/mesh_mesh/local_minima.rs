//! The local minima of the distance of two meshes: pairs of triangles near each other that also face each other.

use elbowroom_spatial::{Pose, Vec3};

use super::cutoff::Cutoff;
use super::facing_kernel::facing_pairs;
use super::leaf_kernel::LeafPair;
use super::leaf_pairs::visit_leaf_pairs;
use super::mesh_pair::MeshPair;
use super::node_kernel::{INTERSECTION, expand};
use super::node_pair::{NodePair, NodePairStack};
use super::normal_cones::NormalConeHierarchy;
use super::relative_placement::{RelativePlacement, spheres_farther_than};
use super::surface_patch::FacingTest;
use super::triangle_batch::{TriangleBatch, robust_closest_points};
use super::triangle_kernel::BATCH;
use super::workspace::{QueryStats, Workspace};
use crate::bvh::LEAF_SIZE;
use crate::separation::Separation;
use crate::triangle::ClosestPoints;

/// Two triangles that face each other within the margin, and their nearest points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LocalMinimum {
    /// Index of the triangle of the first mesh.
    pub triangle_a: u32,
    /// Index of the triangle of the second mesh.
    pub triangle_b: u32,
    /// Distance and nearest points of the two triangles, in the world.
    pub separation: Separation,
}

/// Calls `found` with pairs of triangles no farther apart than `margin` (m) at whose nearest points the distance of the
/// surfaces has a local minimum, once per pair and in no particular order. False if a pose is not usable: then nothing
/// is known.
///
/// Every local minimum up to the margin is found, so also the distance itself if it is not larger. A minimum at a
/// corner or an edge is listed with some or all triangles around it. Of surfaces that cross, some triangles that touch
/// are listed, or none; a mesh inside the other is not noticed. See [`collides`](crate::collides).
///
/// ```
/// use std::sync::Arc;
/// use elbowroom_proximity::advanced::{NormalConeHierarchy, for_each_local_minimum};
/// use elbowroom_proximity::{Cuboid, Shape, Workspace, contact::triangle_surface};
/// use elbowroom_spatial::{Pose, Vec3};
/// let cube = Shape::Cuboid(Cuboid { half_extents: Vec3::splat(0.5) });
/// let cube = NormalConeHierarchy::new(triangle_surface(&cube, 1e-3).unwrap());
/// let there = Pose::from_translation(Vec3::new(1.1, 0.2, 0.0));
/// let mut pairs = Vec::new();
/// let workspace = &mut Workspace::new();
/// assert!(for_each_local_minimum(&cube, &Pose::IDENTITY, &cube, &there, 0.2, workspace, |pair| pairs.push(pair)));
/// // Only the two faces that face each other; each has two triangles.
/// assert!(!pairs.is_empty() && pairs.iter().all(|p| (p.separation.distance - 0.1).abs() < 1e-12));
/// ```
pub fn for_each_local_minimum(
    a: &NormalConeHierarchy,
    a_in_world: &Pose,
    b: &NormalConeHierarchy,
    b_in_world: &Pose,
    margin: f64,
    workspace: &mut Workspace,
    mut found: impl FnMut(LocalMinimum),
) -> bool {
    workspace.begin_query();
    let (mesh_a, mesh_b) = (&**a.mesh(), &**b.mesh());
    let margin = margin.max(0.0);
    if spheres_farther_than(&mesh_a.bvh, a_in_world, &mesh_b.bvh, b_in_world, margin) {
        return true;
    }
    let placement = RelativePlacement::new(&mesh_a.bvh, a_in_world, &mesh_b.bvh, b_in_world);
    if !placement.is_usable() {
        return false;
    }
    let meshes = MeshPair { a: mesh_a, b: mesh_b, placement: &placement, simd_level: workspace.simd_level() };
    let frame = mesh_a.bvh.frame;
    let limit = margin / frame.unit + placement.f64_error;
    let search = LocalMinimumSearch { meshes, a, b, limit };
    search.run(workspace, &mut |(triangle_a, triangle_b), points| {
        let to_world = |p: Vec3| a_in_world.transform_point(p * frame.unit + frame.center);
        let distance = points.squared.sqrt() * frame.unit;
        let error = placement.f64_error * frame.unit;
        let (on_a, on_b) = (to_world(points.on_a), to_world(points.on_b));
        let separation = Separation { distance, lower_bound: (distance - error).max(0.0), on_a, on_b };
        let tolerance = DIRECTION_TOLERANCE + 4.0 * error / distance.max(error);
        let is_nearest = |cones: &NormalConeHierarchy, in_world: &Pose, triangle, point, toward: Vec3| {
            let local = (in_world.inverse_transform_point(point), in_world.inverse_transform_vector(toward));
            cones.vertex_faces.is_nearest_around(
                cones.mesh(),
                triangle,
                local,
                tolerance,
                16.0 * error + cones.mesh().report().weld_tolerance,
            )
        };
        let is_minimum = (on_b - on_a).try_normalize().filter(|_| distance > 2.0 * error).is_none_or(|toward_b| {
            is_nearest(a, a_in_world, triangle_a, on_a, toward_b)
                && is_nearest(b, b_in_world, triangle_b, on_b, -toward_b)
        });
        if is_minimum {
            found(LocalMinimum { triangle_a, triangle_b, separation });
        }
    });
    !workspace.stack.overflowed()
}

/// Angle by which the surface may rise towards the other one, radians. Less would lose minima on flat surfaces to rounding;
/// more would find minima on edges between faces of one plane.
const DIRECTION_TOLERANCE: f64 = 1e-6;

struct LocalMinimumSearch<'a> {
    meshes: MeshPair<'a>,
    a: &'a NormalConeHierarchy,
    b: &'a NormalConeHierarchy,
    /// Largest distance of a pair, units of A.
    limit: f64,
}

impl LocalMinimumSearch<'_> {
    fn run(&self, workspace: &mut Workspace, found: &mut dyn FnMut((u32, u32), &ClosestPoints)) {
        let meshes = &self.meshes;
        let cutoff = Cutoff::new(self.limit, meshes.placement);
        let test = FacingTest::new(meshes.placement, self.limit);
        let Workspace { stack, batch, stats, .. } = workspace;
        batch.clear();
        let mut slots = [(0, 0); BATCH];
        let may_face = |pair: &NodePair| {
            let patch = self.a.of_node(pair.height_a, pair.a);
            patch.may_face(self.b.of_node(pair.height_b, pair.b), &test)
        };
        let expand = |pair: &NodePair, stack: &mut NodePairStack| expand::<INTERSECTION>(meshes, pair, &cutoff, stack);
        visit_leaf_pairs(meshes, expand, stack, stats, may_face, |pair, stats| {
            let leaves = LeafPair { a: pair.a as usize, b: pair.b as usize };
            let patches = (self.a.of_leaf(leaves.a), self.b.of_leaf(leaves.b));
            let facing = facing_pairs(meshes, leaves, patches, self.b.of_node(0, pair.b), &test);
            for (i, j) in facing.lanes() {
                let (slot_a, slot_b) = (pair.a * LEAF_SIZE as u32 + i, pair.b * LEAF_SIZE as u32 + j);
                slots[batch.len()] = (slot_a, slot_b);
                if batch.push(meshes.a, slot_a, meshes.b, slot_b) {
                    self.measure(batch, &slots, stats, found);
                }
            }
            false
        });
        self.measure(batch, &slots, stats, found);
    }

    /// Measures the batch.
    fn measure(
        &self,
        batch: &mut TriangleBatch,
        slots: &[(u32, u32); BATCH],
        stats: &mut QueryStats,
        found: &mut dyn FnMut((u32, u32), &ClosestPoints),
    ) {
        if batch.is_empty() {
            return;
        }
        let MeshPair { a, b, placement, simd_level } = self.meshes;
        let (measured, len) = batch.measure(simd_level, placement);
        stats.batches += 1;
        stats.triangles += len as u32;
        for (lane, &slots) in slots.iter().enumerate().take(len) {
            if measured.at_least[lane] > self.limit {
                continue;
            }
            let (ta, tb) = batch.triangles[lane];
            let points = if measured.is_certain(lane) {
                measured.closest_points(lane)
            } else {
                robust_closest_points(a, ta as usize, b, tb as usize, placement)
            };
            if points.squared <= self.limit * self.limit && self.is_minimum(slots, &points) {
                found((ta, tb), &points);
            }
        }
    }

    /// False if the direction between the points is outside the cone of one of the triangles.
    fn is_minimum(&self, (slot_a, slot_b): (u32, u32), points: &ClosestPoints) -> bool {
        let apart = points.on_b - points.on_a;
        if points.squared.sqrt() <= 2.0 * self.meshes.placement.f64_error {
            return true;
        }
        let Some(toward_b) = apart.try_normalize() else { return true };
        self.a.may_contain(slot_a, toward_b)
            && self.b.may_contain(slot_b, self.meshes.placement.direction_to_b(-toward_b))
    }
}
