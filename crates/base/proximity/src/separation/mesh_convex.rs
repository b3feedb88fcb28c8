//! A mesh and a convex shape or a half-space: traversal of the BVH.
//!
//! The nearest box is visited first, and the best distance so far is the limit.

use elbowroom_spatial::{Pose, Vec3};

use super::core::Core;
use super::gap::{CLOSE, Gap, rounding};
use super::goal::Goal;
use super::mesh_continuous_witness::{mesh_continuous_witness, tolerances};
use super::projections;
use super::segment::Segment;
use super::support_features::bounding_sphere;
use super::tied_triangles::{NearestTriangles, TiedTriangles};
use crate::TriMesh;
use crate::bvh::{BoxDistance, LeastHeight};
use crate::mesh_mesh::QueryStats;
use crate::triangle::{nearest_on_triangle, segment_triangle};
use crate::witness_patch::PatchTolerances;

/// Corners of a triangle whose heights over a core differ by less, as a fraction of the coordinates, are level.
const LEVEL: f64 = 1e-9;

/// The best answer so far.
struct Best {
    gap: Option<Gap>,
    /// The nearest triangle.
    triangle: usize,
    /// Largest gap to search for.
    limit: f64,
    /// Largest difference between tied gaps.
    tie_tolerance: f64,
    /// Spread from which on the witness points are not unique.
    ambiguous_from: f64,
    /// Sum of the distances of the witness points of tied triangles.
    spread: f64,
    /// Gap at which the search ends: a gap no larger is sufficient.
    sufficient: f64,
    /// Smallest proven lower bound of all triangles.
    lower: f64,
    /// Number of measured triangles.
    measured: u32,
    tied: TiedTriangles,
}

impl Best {
    /// Without tolerances, ties do not count.
    fn new(limit: f64, sufficient: f64, tolerances: Option<PatchTolerances>) -> Self {
        Self {
            gap: None,
            triangle: 0,
            limit,
            tie_tolerance: tolerances.map_or(0.0, |t| t.tie),
            ambiguous_from: tolerances.map_or(f64::INFINITY, |t| t.min_size),
            spread: 0.0,
            sufficient,
            lower: f64::INFINITY,
            measured: 0,
            tied: TiedTriangles::new(),
        }
    }

    fn offer(&mut self, triangle: usize, gap: Gap) {
        self.add_spread(&gap);
        self.note_tied(triangle, &gap);
        if gap.lower > self.limit {
            return;
        }
        self.lower = self.lower.min(gap.lower);
        if self.gap.is_none_or(|best| gap.distance < best.distance) {
            self.limit = self.limit.min(gap.distance);
            (self.gap, self.triangle) = (Some(gap), triangle);
        }
    }

    /// Offers a triangle that is proven not to be nearer.
    fn offer_tied(&mut self, triangle: usize, gap: Option<Gap>) {
        if let Some(gap) = gap {
            self.add_spread(&gap);
        }
        if self.tie_tolerance > 0.0 {
            self.tied.note(triangle);
        }
    }

    fn add_spread(&mut self, gap: &Gap) {
        if let Some(best) = &self.gap
            && (best.distance - gap.distance).abs() <= self.tie_tolerance
        {
            self.spread += best.on_a.distance(gap.on_a);
        }
    }

    /// Notes a triangle that may be within twice the tie tolerance of the nearest one.
    fn note_tied(&mut self, triangle: usize, gap: &Gap) {
        let margin = 2.0 * self.tie_tolerance;
        if margin > 0.0 && !(gap.lower > self.limit + margin) {
            if gap.distance + margin < self.limit {
                self.tied.clear();
            }
            self.tied.note(triangle);
        }
    }

    fn is_done(&self) -> bool {
        self.gap.is_some_and(|g| g.distance <= self.sufficient)
    }

    fn finish(&self) -> Option<Gap> {
        self.gap.map(|g| Gap { lower: self.lower.min(g.distance), ..g })
    }

    /// Offers the gaps of all triangles that may be within the limit of a core.
    fn search_beside(&mut self, mesh: &TriMesh, core: &Core, core_in_mesh: &Pose) {
        let (t, scale) = (core_in_mesh.translation, scale(mesh, core, core_in_mesh));
        let query = BoxDistance::new(&mesh.bvh, &core.aabb(), core_in_mesh);
        match core {
            Core::Point => {
                let gap = |i| Gap::closed(nearest_on_triangle(t, mesh.corners(i)), t, scale);
                self.search(mesh, &query, &mut |i, _| Measured::Gap(gap(i)));
            }
            Core::Segment(half) => {
                let axis = Segment { middle: t, direction: core_in_mesh.rotation.z_axis(), half: *half };
                let (p, q) = (axis.at(-half), axis.at(*half));
                self.search(mesh, &query, &mut |i, _| {
                    let near = segment_triangle(p, q, mesh.corners(i));
                    Measured::Gap(Gap::closed(near.on_b, near.on_a, scale))
                });
            }
            _ => {
                let mut triangles = CoreTriangles::new(mesh, core, core_in_mesh, scale);
                self.search(mesh, &query, &mut |i, wanted| triangles.measure(i, &wanted));
            }
        }
    }

    /// Offers the gap that `leaf` computes for every triangle that may be within the limit of the core's box.
    fn search(&mut self, mesh: &TriMesh, query: &BoxDistance, leaf: &mut dyn FnMut(usize, Wanted) -> Measured) {
        let limit = BoxDistance::limit(&mesh.bvh, self.limit + 2.0 * self.tie_tolerance);
        mesh.bvh.traverse(query, limit, &mut |triangle| {
            self.measured += 1;
            match leaf(triangle, self.wanted()) {
                Measured::Beyond => {}
                Measured::NotNearer(gap) => self.offer_tied(triangle, gap),
                Measured::Gap(gap) => self.offer(triangle, gap),
            }
            if self.is_done() {
                return f32::NEG_INFINITY;
            }
            BoxDistance::limit(&mesh.bvh, self.limit + 2.0 * self.tie_tolerance)
        });
    }

    fn wanted(&self) -> Wanted {
        Wanted {
            limit: self.limit,
            margin: 2.0 * self.tie_tolerance,
            nearest: self.gap.map_or(f64::INFINITY, |gap| gap.distance),
            tied_points: self.tie_tolerance > 0.0 && self.spread <= self.ambiguous_from,
        }
    }
}

/// What the search needs to know about a triangle.
#[derive(Debug, Clone, Copy)]
struct Wanted {
    /// Largest gap that counts.
    limit: f64,
    /// Gaps above the limit by at most this may be tied with the smallest one.
    margin: f64,
    /// The smallest gap so far.
    nearest: f64,
    /// Whether the points of a tied gap are needed.
    tied_points: bool,
}

/// What was found of a triangle.
enum Measured {
    /// Its gap is proven to be above the limit by more than the margin.
    Beyond,
    /// Its gap is proven to be no smaller than the smallest one, but for rounding; the gap if its points are wanted.
    NotNearer(Option<Gap>),
    Gap(Gap),
}

/// An upper bound of the gap of a mesh and a convex core: the gap of a triangle that is likely to be near.
pub(super) fn mesh_core_upper_bound(mesh: &TriMesh, core: &Core, core_in_mesh: &Pose) -> f64 {
    let mut best = Best::new(f64::INFINITY, f64::INFINITY, None);
    best.search_beside(mesh, core, core_in_mesh);
    best.gap.map_or(f64::INFINITY, |gap| gap.distance + rounding(scale(mesh, core, core_in_mesh)))
}

/// Bound of the coordinates of a mesh and a core in its frame, metres.
fn scale(mesh: &TriMesh, core: &Core, core_in_mesh: &Pose) -> f64 {
    let extent = mesh.aabb().min.abs().max(mesh.aabb().max.abs()).max_element();
    3.0 * extent + core_in_mesh.translation.abs().max_element() + core.size()
}

/// Gap of a mesh and a convex core in the mesh's frame; `None` if it exceeds the limit by more than the core's
/// radius. Gaps below the radius are contact and are not minimized further.
pub(super) fn mesh_core(
    mesh: &TriMesh,
    core: &Core,
    core_in_mesh: &Pose,
    limit: f64,
    radius: f64,
    goal: Goal,
    stats: &mut QueryStats,
) -> Option<Gap> {
    // The bound in `Gap::separation` decides; this bound must not pass the limit earlier.
    let (limit, sufficient) = (limit + radius + 2.0 * rounding(radius), radius);
    let of_ties = bounding_sphere(core).filter(|_| goal.is_continuous()).map(|(radius, _)| tolerances(mesh, radius));
    let mut best = Best::new(limit, sufficient, of_ties);
    best.search_beside(mesh, core, core_in_mesh);
    stats.triangles_beside_solids += best.measured;
    // The centre of a hull's bounds may be outside the hull.
    let own = if let Core::Hull(hull) = core { hull.vertices()[0] } else { core.middle() };
    let inside = core_in_mesh.transform_point(own);
    if !best.is_done() && mesh.contains(inside) {
        return Some(Gap::touching(inside, inside));
    }
    let gap = best.finish()?;
    if of_ties.is_none() || !gap.is_beyond(radius) {
        return Some(gap);
    }
    let nearest = NearestTriangles { nearest: best.triangle, tied: &best.tied, spread: best.spread };
    Some(mesh_continuous_witness(mesh, core, core_in_mesh, gap, &nearest, stats))
}

/// Triangles beside a core with faces.
struct CoreTriangles<'c> {
    mesh: &'c TriMesh,
    core: &'c Core<'c>,
    core_in_mesh: &'c Pose,
    mesh_in_core: Pose,
    /// Bound of all coordinates, metres, for their rounding.
    scale: f64,
    /// The direction from the core to the last triangle within the limit, and the core's support plane there: likely to
    /// prove that other triangles are not.
    toward_mesh: Option<(Vec3, f64)>,
}

impl<'c> CoreTriangles<'c> {
    fn new(mesh: &'c TriMesh, core: &'c Core<'c>, core_in_mesh: &'c Pose, scale: f64) -> Self {
        Self { mesh, core, core_in_mesh, mesh_in_core: core_in_mesh.inverse(), scale, toward_mesh: None }
    }

    /// The gap of a triangle in the mesh's frame.
    fn measure(&mut self, triangle: usize, wanted: &Wanted) -> Measured {
        let corners = self.mesh.corners(triangle).map(|p| self.mesh_in_core.transform_point(p));
        // The rounding of the transformation back is subtracted from the lower bound below.
        let limit = wanted.limit + 2.0 * rounding(self.scale);
        let reach_limit = limit + wanted.margin;
        let (mut start, mut is_not_nearer) = (Core::Triangle(corners).middle(), false);
        if let Some((direction, reach)) = self.toward_mesh {
            let heights = corners.map(|corner| corner.dot(direction) - reach);
            let above = heights[0].min(heights[1]).min(heights[2]);
            if above - rounding(self.scale) > reach_limit {
                return Measured::Beyond;
            }
            // Whether nearly touching triangles touch, and where, does not depend on the triangles before.
            if above > CLOSE * self.scale {
                is_not_nearer = above >= wanted.nearest;
                start = lowest_points(corners, heights, above + LEVEL * self.scale);
            }
            if is_not_nearer && !wanted.tied_points {
                return Measured::NotNearer(None);
            }
        }
        let core = Core::Triangle(corners);
        let Some(gap) = projections::distance_from(&core, self.core, &Pose::IDENTITY, start, reach_limit) else {
            return Measured::Beyond;
        };
        let lower = (gap.lower - rounding(self.scale)).max(0.0);
        let back = |p| self.core_in_mesh.transform_point(p);
        let in_mesh = Gap { on_a: back(gap.on_a), on_b: back(gap.on_b), lower, ..gap };
        if is_not_nearer {
            return Measured::NotNearer(Some(in_mesh));
        }
        // Ties have no influence on the distance.
        if !(gap.lower > limit) {
            self.toward_mesh = (gap.on_a - gap.on_b).try_normalize().map(|d| (d, self.core.reach(d)));
        }
        Measured::Gap(in_mesh)
    }
}

/// The middle of the corners that are not above `highest`, of which there is one at least.
fn lowest_points(corners: [Vec3; 3], heights: [f64; 3], highest: f64) -> Vec3 {
    let lowest = || corners.iter().zip(heights).filter(|(_, height)| *height <= highest);
    lowest().fold(Vec3::ZERO, |sum, (corner, _)| sum + *corner) / lowest().count().max(1) as f64
}

/// The gap from the mesh's lowest point over a half-space, in the half-space's frame.
pub(super) fn mesh_half_space(mesh: &TriMesh, mesh_in_b: &Pose, stats: &mut QueryStats) -> Gap {
    let up = mesh_in_b.inverse_transform_vector(Vec3::Z);
    let mut lowest = mesh.corners(0)[0];
    mesh.bvh.traverse(&LeastHeight::new(up), LeastHeight::limit(&mesh.bvh, up, lowest), &mut |triangle| {
        stats.triangles_beside_solids += 1;
        for p in mesh.corners(triangle) {
            if p.dot(up) < lowest.dot(up) {
                lowest = p;
            }
        }
        LeastHeight::limit(&mesh.bvh, up, lowest)
    });
    let t = mesh_in_b.translation.abs();
    let size = t.x + t.y + t.z + mesh.aabb().min.abs().max(mesh.aabb().max.abs()).max_element();
    super::half_space::above(mesh_in_b.transform_point(lowest), size)
}

/// The surface point nearest to `p` (local frame) and its triangle.
pub(crate) fn nearest_on_mesh(mesh: &TriMesh, p: Vec3) -> (Vec3, usize) {
    nearest_on_mesh_within(mesh, p, f64::INFINITY).unwrap_or((mesh.corners(0)[0], 0))
}

/// Like [`nearest_on_mesh`]; `None` if the point is farther away than `limit`.
pub(crate) fn nearest_on_mesh_within(mesh: &TriMesh, p: Vec3, limit: f64) -> Option<(Vec3, usize)> {
    let mut best = (limit, Vec3::ZERO, usize::MAX);
    mesh.bvh.traverse(&BoxDistance::from_point(&mesh.bvh, p), BoxDistance::limit(&mesh.bvh, limit), &mut |triangle| {
        let q = nearest_on_triangle(p, mesh.corners(triangle));
        let distance = (q - p).length();
        // Of equal distances the smaller index is used, so that the result does not depend on the order of the tree.
        if distance < best.0 || (distance == best.0 && triangle < best.2) {
            best = (distance, q, triangle);
        }
        BoxDistance::limit(&mesh.bvh, best.0)
    });
    (best.2 != usize::MAX).then_some((best.1, best.2))
}

/// The point of a triangle (mesh frame) nearest to a cylinder; if they overlap, a point in both.
pub(crate) fn nearest_to_cylinder(cylinder: &crate::Cylinder, in_mesh: &Pose, triangle: [Vec3; 3]) -> Vec3 {
    let local = triangle.map(|p| in_mesh.inverse_transform_point(p));
    let gap = projections::distance(&Core::Triangle(local), &Core::Cylinder(*cylinder), &Pose::IDENTITY, f64::INFINITY);
    gap.map_or(triangle[0], |g| nearest_on_triangle(in_mesh.transform_point(g.on_a), triangle))
}
