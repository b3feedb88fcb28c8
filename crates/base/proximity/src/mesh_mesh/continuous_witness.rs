//! Continuous witness points of two meshes: a second traversal over all pairs of triangles that are tied with the
//! nearest pair.

use elbowroom_spatial::Vec3;
use fearless_simd::dispatch;

use super::cutoff::Cutoff;
use super::leaf_kernel::{LeafIntervals, LeafPair, pairs_within};
use super::mesh_pair::MeshPair;
use super::nearest_pair::NearestPair;
use super::node_kernel::{DISTANCE, expand};
use super::node_pair::NodePair;
use super::triangle_batch::{corners_in_a, robust_closest_points};
use super::workspace::Workspace;
use crate::TriMesh;
use crate::bvh::{ARITY, LEAF_SIZE};
use crate::shape::hull::farthest;
use crate::triangle::{ClosestPoints, nearest_on_triangle};
use crate::witness_patch::{
    PatchQuery, PatchTolerances, Polygon, SupportFeature, WitnessChoice, alternating_projections, anchor_between,
    widest_gap,
};

/// The tolerances of two meshes, units of A.
pub(super) fn tolerances(a: &TriMesh, b: &TriMesh) -> PatchTolerances {
    PatchTolerances::of((a.bvh.radius + b.bvh.radius) * a.bvh.frame.inverse)
}

/// True if the closest points lie on faces or edges that are so nearly parallel that other points are tied with
/// them.
pub(super) fn has_parallel_features(meshes: &MeshPair, nearest: &NearestPair, tolerances: PatchTolerances) -> bool {
    let Some(along) = (nearest.points.on_b - nearest.points.on_a).try_normalize() else { return false };
    let (s, t) = corners(meshes, nearest.triangles);
    let feature = |t: &[Vec3; 3], along| SupportFeature::of(t.iter().copied(), farthest(t, along), along, tolerances);
    feature(&s, along).may_overlap(feature(&t, -along), tolerances)
}

/// The closest points, and their triangles, that are nearest to the anchor among all pairs tied with the nearest
/// pair; `None` if the closest points are unique. The result does not depend on the order in which pairs are found.
pub(super) fn continuous_witness(
    meshes: &MeshPair,
    nearest: &NearestPair,
    tolerances: PatchTolerances,
    workspace: &mut Workspace,
) -> Option<(ClosestPoints, (u32, u32))> {
    let MeshPair { a, b, placement, .. } = *meshes;
    let inverse = a.bvh.frame.inverse;
    let (ra, rb) = (a.bvh.radius * inverse, b.bvh.radius * inverse);
    let anchor = anchor_between(Vec3::ZERO, ra, placement.map_to_a(Vec3::ZERO), rb);
    let query = patch_query(meshes, nearest, anchor, tolerances.tie)?;
    let radius = nearest.distance + tolerances.tie;
    let choice = WitnessChoice::new(query, tolerances, nearest.points.on_a);
    let mut traversal = TiedPairs { meshes, radius, choice };
    traversal.run(workspace);
    let (triangles, on_a, on_b) = traversal.choice.chosen()?;
    Some((ClosestPoints { squared: nearest.distance * nearest.distance, on_a, on_b }, triangles))
}

/// The direction with the widest gap between the two nearest triangles. It is the direction of the closest points,
/// unless they are so close that it has lost its digits and a face normal is more accurate.
fn patch_query(meshes: &MeshPair, nearest: &NearestPair, anchor: Vec3, tolerance: f64) -> Option<PatchQuery> {
    let (s, t) = corners(meshes, nearest.triangles);
    let toward_b = (nearest.points.on_b - nearest.points.on_a).try_normalize()?;
    let ends = |d: Vec3| {
        let high = s.iter().fold(f64::NEG_INFINITY, |m, p| m.max(d.dot(*p)));
        [high, t.iter().fold(f64::INFINITY, |m, p| m.min(d.dot(*p)))]
    };
    let normal = |t: &[Vec3; 3]| {
        let n = (t[1] - t[0]).cross(t[2] - t[0]).try_normalize()?;
        Some(if n.dot(toward_b) < 0.0 { -n } else { n })
    };
    let directions = [Some(toward_b), normal(&s), normal(&t)];
    let direction = widest_gap(directions.into_iter().flatten(), &ends)?;
    Some(PatchQuery { direction, ends: ends(direction), tolerance, anchor })
}

fn corners(meshes: &MeshPair, (ta, tb): (u32, u32)) -> ([Vec3; 3], [Vec3; 3]) {
    corners_in_a(meshes.a, ta as usize, meshes.b, tb as usize, meshes.placement)
}

/// The traversal of all pairs of triangles within the radius.
struct TiedPairs<'a> {
    meshes: &'a MeshPair<'a>,
    /// Largest distance of tied pairs.
    radius: f64,
    choice: WitnessChoice<(u32, u32)>,
}

impl TiedPairs<'_> {
    fn run(&mut self, workspace: &mut Workspace) {
        let meshes = self.meshes;
        let mut cutoff = Cutoff::new(self.radius, meshes.placement);
        // Without this, a hundred times as many pairs of large triangles are left to the exact test.
        cutoff.align(self.choice.query.direction, meshes.placement);
        let Workspace { stack, batch, stats, .. } = workspace;
        batch.clear();
        stack.clear();
        stack.push(NodePair::root(&meshes.a.bvh, &meshes.b.bvh));
        while let Some(pair) = stack.pop() {
            // For parallel faces the number of tied pairs is the product of their numbers of triangles; only pairs near the
            // anchor matter.
            if self.choice.is_beaten(|anchor| self.nearest_in_box(&pair, anchor)) {
                continue;
            }
            if !pair.is_leaves() {
                stats.nodes += 1;
                let first = stack.len();
                stats.boxes += expand::<DISTANCE>(meshes, &pair, &cutoff, stack);
                let anchor = self.choice.query.anchor;
                stack.sort_from(first, |pair| self.nearest_in_box(pair, anchor).distance(anchor));
                continue;
            }
            stats.leaves += 1;
            let leaves = LeafPair { a: pair.a as usize, b: pair.b as usize };
            let mut intervals = LeafIntervals::UNKNOWN;
            let left =
                dispatch!(meshes.simd_level, simd => pairs_within(simd, meshes, leaves, &cutoff, &mut intervals));
            for (i, j) in left.lanes() {
                stats.triangles += 1;
                self.visit(pair.a * LEAF_SIZE as u32 + i, pair.b * LEAF_SIZE as u32 + j);
            }
        }
    }

    /// The point nearest to `p` in the box of a pair's first node.
    fn nearest_in_box(&self, pair: &NodePair, p: Vec3) -> Vec3 {
        let (parent, lane) = self.meshes.a.bvh.parent(pair.height_a.into(), pair.a as usize);
        let at = |rows: &[[f32; ARITY]; 3]| Vec3::new(rows[0][lane].into(), rows[1][lane].into(), rows[2][lane].into());
        let (center, half) = (at(&parent.center), at(&parent.half));
        p.max(center - half).min(center + half)
    }

    /// Offers the witness points of a pair of slots.
    fn visit(&mut self, slot_a: u32, slot_b: u32) {
        let MeshPair { a, b, placement, .. } = *self.meshes;
        let (ta, tb) = (a.bvh.triangle(slot_a), b.bvh.triangle(slot_b));
        let (s, t) = corners_in_a(a, ta, b, tb, placement);
        if self.choice.is_beaten(|anchor| nearest_on_triangle(anchor, s)) {
            return;
        }
        let found = robust_closest_points(a, ta, b, tb, placement);
        if !(found.squared <= self.radius * self.radius) {
            return;
        }
        let triangles = (ta as u32, tb as u32);
        self.choice.note_point(found.on_a);
        self.choice.offer(triangles, found.on_a, found.on_b);
        if let Some(patch) = self.choice.query.closest_points(&Polygon::new(s), &Polygon::new(t)) {
            let onto_b = |p| nearest_on_triangle(p, t);
            let (on_a, on_b) = alternating_projections(patch.on_a, &|q| nearest_on_triangle(q, s), &onto_b);
            // Faces that are inclined to the common direction may have been clipped to points that are not tied.
            let limit = self.radius + 2.0 * self.choice.query.tolerance;
            if (on_a - on_b).length_squared() <= limit * limit {
                self.choice.note_patch(patch.patch_size);
                self.choice.offer(triangles, on_a, on_b);
            }
        }
    }
}
