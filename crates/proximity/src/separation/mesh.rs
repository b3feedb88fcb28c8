//! Meshes against everything: descent through the tree of boxes, nearest box first, with the best answer so far as
//! the limit.

use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::core::{Core, Gap, rounding};
use super::projections;
use super::segment::{Segment, nearest_to_box};
use crate::shape::Bvh;
use crate::triangle::{nearest_on_triangle, segment_triangle};
use crate::{Cuboid, TriMesh};

/// The best answer so far.
struct Best {
    gap: Option<Gap>,
    /// Nothing farther is of interest.
    limit: f64,
    /// Nothing nearer makes a difference.
    enough: f64,
    /// Smallest proven bound of all leaves.
    lower: f64,
}

impl Best {
    fn new(limit: f64, enough: f64) -> Self {
        Self { gap: None, limit, enough, lower: f64::INFINITY }
    }

    fn offer(&mut self, gap: Gap) {
        self.lower = self.lower.min(gap.lower);
        if self.gap.is_none_or(|best| gap.distance < best.distance) {
            self.limit = self.limit.min(gap.distance);
            self.gap = Some(gap);
        }
    }

    fn done(&self) -> bool {
        self.gap.is_some_and(|g| g.distance <= self.enough)
    }

    fn finish(self) -> Option<Gap> {
        self.gap.map(|g| Gap { lower: self.lower.min(g.distance), ..g })
    }
}

/// Distance of a mesh and a convex core in the mesh's frame. Not below `enough` (the core's radius) is looked closely.
pub(super) fn mesh_core(mesh: &TriMesh, core: &Core, core_in_mesh: &Pose, limit: f64, enough: f64) -> Option<Gap> {
    let t = core_in_mesh.translation;
    let extent = mesh.aabb().min.abs().max(mesh.aabb().max.abs()).max_element();
    let scale = 3.0 * extent + t.abs().max_element() + core.size();
    let mut best = Best::new(limit, enough);
    match core {
        Core::Point => {
            let box_distance = |b: &Aabb| (t - t.clamp(b.min, b.max)).length();
            let leaf = |i, _| Some(Gap::closed(nearest_on_triangle(t, mesh.corners(i)), t, scale));
            descend(&mesh.bvh, 0, &box_distance, &leaf, &mut best);
        }
        Core::Segment(half) => {
            let axis = Segment { middle: t, direction: core_in_mesh.rotation.z_axis(), half: *half };
            let (p, q) = (axis.at(-half), axis.at(*half));
            let leaf = |i, _| {
                let near = segment_triangle(p, q, mesh.corners(i));
                Some(Gap::closed(near.on_b, near.on_a, scale))
            };
            descend(&mesh.bvh, 0, &|b| segment_to_box(&axis, b), &leaf, &mut best);
        }
        _ => {
            let bounds = core_bounds(core, core_in_mesh);
            let mesh_in_core = core_in_mesh.inverse();
            let leaf = |i, limit| {
                let triangle = Core::Triangle(mesh.corners(i).map(|p| mesh_in_core.transform_point(p)));
                let gap = projections::distance(&triangle, core, &Pose::IDENTITY, limit)?;
                let back = |p| core_in_mesh.transform_point(p);
                Some(Gap {
                    on_a: back(gap.on_a),
                    on_b: back(gap.on_b),
                    lower: (gap.lower - rounding(scale)).max(0.0),
                    ..gap
                })
            };
            descend(&mesh.bvh, 0, &|b| b.distance(&bounds), &leaf, &mut best);
        }
    }
    let inside = core_in_mesh.transform_point(core.middle());
    if !best.done() && mesh.contains(inside) {
        return Some(Gap::touching(inside, inside));
    }
    best.finish()
}

/// The mesh's lowest point over a half-space, in the half-space's frame.
pub(super) fn mesh_half_space(mesh: &TriMesh, mesh_in_b: &Pose) -> Gap {
    let up = mesh_in_b.inverse_transform_vector(Vec3::Z);
    let mut best = Best::new(f64::INFINITY, f64::NEG_INFINITY);
    // Heights may be negative, so the search runs on heights above the lowest conceivable one.
    let bottom = lowest_of(mesh.aabb(), up);
    let box_height = |b: &Aabb| lowest_of(b, up) - bottom;
    let leaf = |i, _| {
        let p = mesh.corners(i).into_iter().fold(None, |low: Option<Vec3>, p| match low {
            Some(q) if q.dot(up) <= p.dot(up) => Some(q),
            _ => Some(p),
        })?;
        Some(Gap { distance: p.dot(up) - bottom, lower: 0.0, on_a: p, on_b: p })
    };
    descend(&mesh.bvh, 0, &box_height, &leaf, &mut best);
    let lowest = mesh_in_b.transform_point(best.gap.map_or(Vec3::ZERO, |g| g.on_a));
    let t = mesh_in_b.translation.abs();
    super::half_space::above(lowest, t.x + t.y + t.z + mesh.aabb().min.abs().max(mesh.aabb().max.abs()).max_element())
}

fn lowest_of(b: &Aabb, up: Vec3) -> f64 {
    b.center().dot(up) - 0.5 * b.extent().dot(up.abs())
}

fn segment_to_box(axis: &Segment, b: &Aabb) -> f64 {
    let local = Segment { middle: axis.middle - b.center(), ..*axis };
    let solid = Cuboid { half_extents: b.extent() * 0.5 };
    let p = nearest_to_box(&local, &solid);
    (p - solid.nearest(p)).length()
}

fn core_bounds(core: &Core, in_mesh: &Pose) -> Aabb {
    let high = |axis: Vec3| core.reach(in_mesh.inverse_transform_vector(axis));
    let max = Vec3::new(high(Vec3::X), high(Vec3::Y), high(Vec3::Z));
    let min = -Vec3::new(high(-Vec3::X), high(-Vec3::Y), high(-Vec3::Z));
    Aabb { min: min + in_mesh.translation, max: max + in_mesh.translation }
}

fn descend(
    bvh: &Bvh,
    node: usize,
    bound: &impl Fn(&Aabb) -> f64,
    leaf: &impl Fn(usize, f64) -> Option<Gap>,
    best: &mut Best,
) {
    if bvh.nodes[node].count > 0 {
        for &i in bvh.leaf(node) {
            if let Some(gap) = leaf(i as usize, best.limit)
                && !(gap.lower > best.limit)
            {
                best.offer(gap);
            }
        }
        return;
    }
    let (left, right) = bvh.children(node);
    let (l, r) = (bound(&bvh.nodes[left].aabb), bound(&bvh.nodes[right].aabb));
    let order = if r < l { [(r, right), (l, left)] } else { [(l, left), (r, right)] };
    for (near, child) in order {
        if !(near > best.limit) && !best.done() {
            descend(bvh, child, bound, leaf, best);
        }
    }
}

/// The surface point nearest to `p` (local frame) and its triangle.
pub(crate) fn nearest_on_mesh(mesh: &TriMesh, p: Vec3) -> (Vec3, usize) {
    let nearest = std::cell::Cell::new((f64::INFINITY, mesh.corners(0)[0], 0));
    let leaf = |i, _| {
        let q = nearest_on_triangle(p, mesh.corners(i));
        let distance = (q - p).length();
        if distance < nearest.get().0 {
            nearest.set((distance, q, i));
        }
        Some(Gap { distance, lower: distance, on_a: q, on_b: p })
    };
    let mut best = Best::new(f64::INFINITY, 0.0);
    descend(&mesh.bvh, 0, &|b| (p - p.clamp(b.min, b.max)).length(), &leaf, &mut best);
    let (_, q, triangle) = nearest.get();
    (q, triangle)
}
