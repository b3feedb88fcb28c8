//! Continuous witness points of a mesh and a convex core.

use elbowroom_spatial::{Pose, Vec3};

use super::continuous_witness::{transformed, with_points};
use super::core::Core;
use super::gap::Gap;
use super::support_features::{bounding_sphere, for_each_face, nearest, normal, support_feature};
use super::tied_triangles::NearestTriangles;
use crate::TriMesh;
use crate::bvh::BoxDistance;
use crate::mesh_mesh::QueryStats;
use crate::shape::hull::farthest;
use crate::triangle::nearest_on_triangle;
use crate::witness_patch::{
    PatchQuery, PatchTolerances, Polygon, SupportFeature, WitnessChoice, alternating_projections, anchor_between,
    widest_gap,
};

/// The tolerances of a mesh and a core of this radius, m.
pub(super) fn tolerances(mesh: &TriMesh, radius: f64) -> PatchTolerances {
    PatchTolerances::of(mesh.bvh.bounding_sphere().1 + radius)
}

/// Like [`continuous_witness`](super::continuous_witness::continuous_witness), for a mesh (first) and a core, in the
/// mesh's frame.
pub(super) fn mesh_continuous_witness(
    mesh: &TriMesh,
    core: &Core,
    core_in_mesh: &Pose,
    gap: Gap,
    triangles: &NearestTriangles<'_>,
    stats: &mut QueryStats,
) -> Gap {
    let Some((core_radius, core_center)) = bounding_sphere(core) else { return gap };
    let Some(toward_core) = (gap.on_b - gap.on_a).try_normalize() else { return gap };
    let tolerances = tolerances(mesh, core_radius);
    let to_core = |d: Vec3| core_in_mesh.inverse_transform_vector(d);
    let t = mesh.corners(triangles.nearest);
    let has_parallel_features = || {
        let of_mesh = SupportFeature::of(t.iter().copied(), farthest(&t, toward_core), toward_core, tolerances);
        let of_core = transformed(support_feature(core, to_core(-toward_core), tolerances), core_in_mesh);
        of_mesh.may_overlap(of_core, tolerances)
    };
    if !(triangles.spread > tolerances.min_size || has_parallel_features()) {
        return gap;
    }
    let ends = |d: Vec3| {
        let high = t.iter().fold(f64::NEG_INFINITY, |high: f64, p| high.max(d.dot(*p)));
        [high, core_in_mesh.transform_point(core.support(to_core(-d))).dot(d)]
    };
    let of_triangle = (t[1] - t[0]).cross(t[2] - t[0]).try_normalize().unwrap_or(toward_core);
    let of_triangle = if of_triangle.dot(toward_core) < 0.0 { -of_triangle } else { of_triangle };
    let of_core = -core_in_mesh.transform_vector(normal(core, to_core(-toward_core), to_core(-toward_core)));
    let Some(direction) = widest_gap([toward_core, of_triangle, of_core], &ends) else { return gap };
    let (center, radius) = mesh.bvh.bounding_sphere();
    let anchor = anchor_between(center, radius, core_in_mesh.transform_point(core_center), core_radius);
    let query = PatchQuery { direction, ends: ends(direction), tolerance: tolerances.tie, anchor };
    let choice = WitnessChoice::new(query, tolerances, gap.on_a);
    let reach = gap.distance + 2.0 * tolerances.tie;
    let mut search = WitnessSearch { mesh, core, core_in_mesh, reach, choice };
    search.run(triangles, stats);
    let Some((_, on_a, on_b)) = search.choice.chosen() else { return gap };
    with_points(gap, on_a, on_b, tolerances.tie)
}

/// The search for the witness points among tied triangles.
struct WitnessSearch<'a> {
    mesh: &'a TriMesh,
    core: &'a Core<'a>,
    core_in_mesh: &'a Pose,
    /// Largest distance of tied points, m.
    reach: f64,
    choice: WitnessChoice<usize>,
}

impl WitnessSearch<'_> {
    fn run(&mut self, triangles: &NearestTriangles<'_>, stats: &mut QueryStats) {
        // The tied triangle nearest to the anchor is likely to be chosen, and excludes most others.
        let anchor = self.choice.query.anchor;
        let (mesh, query) = (self.mesh, self.choice.query);
        let mut likely = (f64::INFINITY, triangles.nearest);
        self.for_each_tied(triangles, &mut |_, triangle| {
            let corners = mesh.corners(triangle);
            if query.reaches_top(corners) && nearest_in_box(anchor, corners).distance(anchor) < likely.0 {
                let distance = nearest_on_triangle(anchor, corners).distance(anchor);
                likely = if distance < likely.0 { (distance, triangle) } else { likely };
            }
        });
        self.offer(likely.1, stats);
        self.for_each_tied(triangles, &mut |search, triangle| {
            let corners = mesh.corners(triangle);
            let can_be_chosen = triangle != likely.1
                && query.reaches_top(corners)
                && !search.choice.is_beaten(|anchor| nearest_in_box(anchor, corners))
                && !search.choice.is_beaten(|anchor| nearest_on_triangle(anchor, corners));
            if can_be_chosen {
                search.offer(triangle, stats);
            }
        });
    }

    fn for_each_tied(&mut self, triangles: &NearestTriangles<'_>, visit: &mut dyn FnMut(&mut Self, usize)) {
        if let Some(tied) = triangles.tied.all() {
            for triangle in tied {
                visit(self, *triangle as usize);
            }
            return;
        }
        let bvh = &self.mesh.bvh;
        let limit = BoxDistance::limit(bvh, self.reach);
        bvh.traverse(&BoxDistance::new(bvh, &self.core.aabb(), self.core_in_mesh), limit, &mut |triangle| {
            visit(self, triangle);
            limit
        });
    }

    /// Offers the tied points of a triangle and each face of the core.
    fn offer(&mut self, triangle: usize, stats: &mut QueryStats) {
        let Self { mesh, core, core_in_mesh, reach, choice } = self;
        let corners = mesh.corners(triangle);
        let of_mesh = Polygon::new(corners);
        let onto_mesh = |q| nearest_on_triangle(q, corners);
        let onto_core = |p: Vec3| core_in_mesh.transform_point(nearest(core, core_in_mesh.inverse_transform_point(p)));
        let toward_mesh = core_in_mesh.inverse_transform_vector(-choice.query.direction);
        for_each_face(core, toward_mesh, &mut |of_core| {
            stats.triangles_beside_solids += 1;
            let of_core = Polygon::new(of_core.iter().map(|p| core_in_mesh.transform_point(*p)));
            let Some(found) = choice.query.closest_points(&of_mesh, &of_core) else { return };
            let (on_a, on_b) = alternating_projections(found.on_a, &onto_mesh, &onto_core);
            if (on_a - on_b).length_squared() <= *reach * *reach {
                choice.note_patch(found.patch_size);
                choice.note_point(on_a);
                choice.offer(triangle, on_a, on_b);
            }
        });
    }
}

/// The point of the bounding box of a triangle that is nearest to `p`.
fn nearest_in_box(p: Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    p.max(a.min(b).min(c)).min(a.max(b).max(c))
}
