//! Continuous witness points of a mesh and a convex core.

use elbowroom_spatial::{Pose, Vec3};

use super::continuous_witness::{transformed, with_points};
use super::core::Core;
use super::gap::Gap;
use super::support_features::{bounding_sphere, for_each_face, nearest, normal, support_feature};
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
/// mesh's frame. `nearest_triangle` contains the point of the gap; `spread` is the sum of the distances of tied
/// points found before.
pub(super) fn mesh_continuous_witness(
    mesh: &TriMesh,
    core: &Core,
    core_in_mesh: &Pose,
    gap: Gap,
    nearest_triangle: usize,
    spread: f64,
    stats: &mut QueryStats,
) -> Gap {
    let Some((core_radius, core_center)) = bounding_sphere(core) else { return gap };
    let Some(toward_core) = (gap.on_b - gap.on_a).try_normalize() else { return gap };
    let tolerances = tolerances(mesh, core_radius);
    let to_core = |d: Vec3| core_in_mesh.inverse_transform_vector(d);
    let t = mesh.corners(nearest_triangle);
    let has_parallel_features = || {
        let of_mesh = SupportFeature::of(t.iter().copied(), farthest(&t, toward_core), toward_core, tolerances);
        let of_core = transformed(support_feature(core, to_core(-toward_core), tolerances), core_in_mesh);
        of_mesh.may_overlap(of_core, tolerances)
    };
    if !(spread > tolerances.min_size || has_parallel_features()) {
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
    let mut choice = WitnessChoice::new(query, tolerances, gap.on_a);
    let reach = gap.distance + 2.0 * tolerances.tie;
    let limit = BoxDistance::limit(&mesh.bvh, reach);
    let onto_core = |p: Vec3| core_in_mesh.transform_point(nearest(core, core_in_mesh.inverse_transform_point(p)));
    mesh.bvh.traverse(&BoxDistance::new(&mesh.bvh, &core.aabb(), core_in_mesh), limit, &mut |triangle| {
        let corners = mesh.corners(triangle);
        if choice.is_beaten(|anchor| nearest_on_triangle(anchor, corners)) {
            return limit;
        }
        let of_mesh = Polygon::new(corners);
        for_each_face(core, to_core(-direction), &mut |of_core| {
            stats.triangles_beside_solids += 1;
            let of_core = Polygon::new(of_core.iter().map(|p| core_in_mesh.transform_point(*p)));
            let Some(found) = choice.query.closest_points(&of_mesh, &of_core) else { return };
            let onto_mesh = |q| nearest_on_triangle(q, corners);
            let (on_a, on_b) = alternating_projections(found.on_a, &onto_mesh, &onto_core);
            if (on_a - on_b).length_squared() <= reach * reach {
                choice.note_patch(found.patch_size);
                choice.note_point(on_a);
                choice.offer(triangle, on_a, on_b);
            }
        });
        limit
    });
    let Some((_, on_a, on_b)) = choice.chosen() else { return gap };
    with_points(gap, on_a, on_b, tolerances.tie)
}
