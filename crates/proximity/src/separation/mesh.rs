//! A mesh against everything simple: descent through its tree, most promising box first, with the best answer so far as
//! the limit.

use elbowroom_spatial::{Aabb, Pose, Vec3};

use super::Points;
use super::core::{Core, Gap, rounding};
use super::flat::ball;
use super::projections;
use super::segment::Segment;
use super::steady::{grain_of_mesh, steady_of_mesh};
use crate::TriMesh;
use crate::mesh::{BoxProbe, Height};
use crate::triangle::{nearest_on_triangle, segment_triangle};

/// The best answer so far.
struct Best {
    gap: Option<Gap>,
    /// The triangle with its point.
    triangle: usize,
    /// Nothing farther is of interest.
    limit: f64,
    /// Pairs that are farther than the best by no more are noticed.
    grain: f64,
    /// How far apart, added up, points of such pairs were seen.
    spread: f64,
    /// Nothing nearer makes a difference.
    enough: f64,
    /// Smallest proven bound of all leaves.
    lower: f64,
}

impl Best {
    fn new(limit: f64, enough: f64, grain: f64) -> Self {
        let (triangle, spread) = (0, 0.0);
        Self { gap: None, triangle, limit, grain, spread, enough, lower: f64::INFINITY }
    }

    fn offer(&mut self, triangle: usize, gap: Gap) {
        if let Some(best) = &self.gap
            && (best.distance - gap.distance).abs() <= self.grain
        {
            self.spread += best.on_a.distance(gap.on_a);
        }
        if gap.lower > self.limit {
            return;
        }
        self.lower = self.lower.min(gap.lower);
        if self.gap.is_none_or(|best| gap.distance < best.distance) {
            self.limit = self.limit.min(gap.distance);
            (self.gap, self.triangle) = (Some(gap), triangle);
        }
    }

    fn done(&self) -> bool {
        self.gap.is_some_and(|g| g.distance <= self.enough)
    }

    fn finish(self) -> Option<Gap> {
        self.gap.map(|g| Gap { lower: self.lower.min(g.distance), ..g })
    }

    /// Asks `leaf` about every triangle that may be within the limit of the core's box.
    fn search(&mut self, mesh: &TriMesh, probe: &BoxProbe, leaf: &dyn Fn(usize, f64) -> Option<Gap>) {
        mesh.tree.visit(probe, BoxProbe::limit(&mesh.tree, self.limit), &mut |triangle| {
            if let Some(gap) = leaf(triangle, self.limit + self.grain) {
                self.offer(triangle, gap);
            }
            if self.done() { f32::NEG_INFINITY } else { BoxProbe::limit(&mesh.tree, self.limit + self.grain) }
        });
    }
}

/// Distance of a mesh and a convex core in the mesh's frame, where that less the core's radius is not above the limit.
/// Not below the radius is looked closely.
pub(super) fn mesh_core(
    mesh: &TriMesh,
    core: &Core,
    core_in_mesh: &Pose,
    limit: f64,
    radius: f64,
    points: Points,
) -> Option<Gap> {
    // The bound in `world` decides; this one must not pass the limit before it.
    let (limit, enough) = (limit + radius + 2.0 * rounding(radius), radius);
    let t = core_in_mesh.translation;
    let extent = mesh.aabb().min.abs().max(mesh.aabb().max.abs()).max_element();
    let scale = 3.0 * extent + t.abs().max_element() + core.size();
    let grain = match ball(core) {
        Some((radius, _)) if points == Points::Steady => grain_of_mesh(mesh, radius).0,
        _ => 0.0,
    };
    let mut best = Best::new(limit, enough, grain);
    let probe = BoxProbe::new(&mesh.tree, &bounds(core), core_in_mesh);
    match core {
        Core::Point => {
            best.search(mesh, &probe, &|i, _| Some(Gap::closed(nearest_on_triangle(t, mesh.corners(i)), t, scale)));
        }
        Core::Segment(half) => {
            let axis = Segment { middle: t, direction: core_in_mesh.rotation.z_axis(), half: *half };
            let (p, q) = (axis.at(-half), axis.at(*half));
            best.search(mesh, &probe, &|i, _| {
                let near = segment_triangle(p, q, mesh.corners(i));
                Some(Gap::closed(near.on_b, near.on_a, scale))
            });
        }
        _ => {
            let mesh_in_core = core_in_mesh.inverse();
            best.search(mesh, &probe, &|i, limit| {
                let triangle = Core::Triangle(mesh.corners(i).map(|p| mesh_in_core.transform_point(p)));
                // A bound that passes the limit only before the way back is taken off does not count.
                let limit = limit + 2.0 * rounding(scale);
                let gap = projections::distance(&triangle, core, &Pose::IDENTITY, limit)?;
                let back = |p| core_in_mesh.transform_point(p);
                let lower = (gap.lower - rounding(scale)).max(0.0);
                Some(Gap { on_a: back(gap.on_a), on_b: back(gap.on_b), lower, ..gap })
            });
        }
    }
    // The middle of a hull's bounds may be outside of it.
    let own = if let Core::Hull(hull) = core { hull.vertices()[0] } else { core.middle() };
    let inside = core_in_mesh.transform_point(own);
    if !best.done() && mesh.contains(inside) {
        return Some(Gap::touching(inside, inside));
    }
    let (triangle, spread) = (best.triangle, best.spread);
    let gap = best.finish()?;
    let apart = grain > 0.0 && gap.is_beyond(radius);
    Some(if apart { steady_of_mesh(mesh, core, core_in_mesh, gap, triangle, spread) } else { gap })
}

/// Bounds of a core in its own frame.
pub(super) fn bounds(core: &Core) -> Aabb {
    let high = |axis: Vec3| core.reach(axis);
    let max = Vec3::new(high(Vec3::X), high(Vec3::Y), high(Vec3::Z));
    Aabb { min: -Vec3::new(high(-Vec3::X), high(-Vec3::Y), high(-Vec3::Z)), max }
}

/// The mesh's lowest point over a half-space, in the half-space's frame.
pub(super) fn mesh_half_space(mesh: &TriMesh, mesh_in_b: &Pose) -> Gap {
    let up = mesh_in_b.inverse_transform_vector(Vec3::Z);
    let mut lowest = mesh.corners(0)[0];
    mesh.tree.visit(&Height::new(up), Height::limit(&mesh.tree, up, lowest), &mut |triangle| {
        for p in mesh.corners(triangle) {
            if p.dot(up) < lowest.dot(up) {
                lowest = p;
            }
        }
        Height::limit(&mesh.tree, up, lowest)
    });
    let t = mesh_in_b.translation.abs();
    let size = t.x + t.y + t.z + mesh.aabb().min.abs().max(mesh.aabb().max.abs()).max_element();
    super::half_space::above(mesh_in_b.transform_point(lowest), size)
}

/// The surface point nearest to `p` (local frame) and its triangle.
pub(crate) fn nearest_on_mesh(mesh: &TriMesh, p: Vec3) -> (Vec3, usize) {
    let mut best = (f64::INFINITY, mesh.corners(0)[0], 0);
    let probe = BoxProbe::new(&mesh.tree, &Aabb { min: Vec3::ZERO, max: Vec3::ZERO }, &Pose::from_translation(p));
    mesh.tree.visit(&probe, f32::INFINITY, &mut |triangle| {
        let q = nearest_on_triangle(p, mesh.corners(triangle));
        let distance = (q - p).length();
        // Of equals the lower number, so that the order of the tree does not show.
        if distance < best.0 || (distance == best.0 && triangle < best.2) {
            best = (distance, q, triangle);
        }
        BoxProbe::limit(&mesh.tree, best.0)
    });
    (best.1, best.2)
}

/// The point of a triangle (mesh frame) nearest to a cylinder; where they overlap, one in both.
pub(crate) fn nearest_to_cylinder(cylinder: &crate::Cylinder, in_mesh: &Pose, triangle: [Vec3; 3]) -> Vec3 {
    let local = triangle.map(|p| in_mesh.inverse_transform_point(p));
    let gap = projections::distance(&Core::Triangle(local), &Core::Cylinder(*cylinder), &Pose::IDENTITY, f64::INFINITY);
    gap.map_or(triangle[0], |g| nearest_on_triangle(in_mesh.transform_point(g.on_a), triangle))
}
