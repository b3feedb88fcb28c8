//! Balls with centres inside the solid, as large as the slack allows.

use elbowroom_proximity::TriMesh;
use elbowroom_spatial::Vec3;

use super::ball::{Ball, ROUNDING_M};
use super::placement::PlacedShapes;
use super::surface_voxels::SurfaceVoxel;
use super::voxel_grid::{Voxel, VoxelGrid};

/// Largest number of iterations of the shrinking ball.
const SHRINKINGS: usize = 8;
/// Near an edge: distances of ball centres from the surface along the mean of its normals, in multiples of the slack.
const BESIDE_EDGES: [f64; 2] = [1.0, 2.0];
/// Cosine below which the mean of the normals differs so much from the triangle's normal that an edge is near.
const EDGE_COSINE: f64 = 0.97;
/// Radius of the largest ball, in multiples of the slack, below which an edge is near.
const NEAR_EDGE: f64 = 4.0;

/// The surface beyond which outer spheres must not protrude.
pub(super) struct MedialBalls<'g, 's> {
    placed: &'g PlacedShapes<'s>,
    grid: &'g VoxelGrid,
    /// The triangles near the outside.
    visible: TriMesh,
    slack_m: f64,
}

impl<'g, 's> MedialBalls<'g, 's> {
    /// Returns `None` if no triangle is visible.
    pub fn new(placed: &'g PlacedShapes<'s>, grid: &'g VoxelGrid, slack_m: f64) -> Option<Self> {
        let vertices = grid.surface.visible.concat();
        let triangles = (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let slack_m = (slack_m - placed.chord_error_m - 2.0 * ROUNDING_M).max(ROUNDING_M);
        Some(Self { placed, grid, visible: TriMesh::new(vertices, triangles).ok()?, slack_m })
    }

    /// The largest ball about a point that protrudes by at most the slack; `None` outside.
    pub fn largest(&self, centre: Vec3) -> Option<Ball> {
        let nearest = self.visible.nearest_point_within(centre, f64::INFINITY)?;
        self.ball(centre, nearest.distance(centre))
    }

    /// The ball about a centre at a given distance from the surface, enlarged by the slack.
    fn ball(&self, centre: Vec3, distance_m: f64) -> Option<Ball> {
        let depth_m = match self.grid.at(centre) {
            Voxel::Outside => return None,
            Voxel::Inside => distance_m,
            // The centre may be just outside.
            Voxel::Surface if self.placed.depth_m(centre) > 0.0 => distance_m,
            Voxel::Surface => -distance_m,
        };
        let radius = depth_m + self.slack_m;
        (radius > 0.0).then_some(Ball { centre, radius })
    }

    /// Balls that touch the surface in a voxel from inside, apart from the slack.
    ///
    /// If they are small, also balls beside the edge.
    pub fn candidates(&self, voxel: &SurfaceVoxel) -> Vec<Ball> {
        let [a, b, c] = self.placed.triangles[voxel.triangle as usize];
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return Vec::new() };
        let mut balls: Vec<Ball> = [normal, -normal].iter().filter_map(|&n| self.touching(voxel.anchor, n)).collect();
        let is_small = balls.iter().all(|ball| ball.radius < NEAR_EDGE * self.slack_m);
        if let Some(inward) = voxel.inward().filter(|i| is_small && i.dot(normal).abs() < EDGE_COSINE) {
            let centre = |share: &f64| voxel.anchor + inward * (share * self.slack_m);
            balls.extend(BESIDE_EDGES.iter().filter_map(|share| self.largest(centre(share))));
        }
        balls
    }

    /// The largest ball that touches the surface at a point, enlarged by the slack.
    ///
    /// Source: Ma, Bae, Choi: *3D medial axis point approximation using nearest neighbors and the normal field*, 2012.
    fn touching(&self, surface: Vec3, inward: Vec3) -> Option<Ball> {
        let step = self.grid.lattice.step_m;
        if self.grid.at(surface + inward * (1.5 * step)) == Voxel::Outside {
            return None;
        }
        let mut radius = 0.5 * self.grid.counts.iter().map(|&n| n as f64 * step).fold(f64::INFINITY, f64::min);
        for _ in 0..SHRINKINGS {
            let centre = surface + inward * radius;
            if self.grid.at(centre) == Voxel::Outside {
                radius *= 0.5;
                continue;
            }
            let Some(near) = self.visible.nearest_point_within(centre, radius) else {
                return self.ball(centre, radius);
            };
            if near.distance(centre) >= radius - 0.1 * step {
                return self.ball(centre, near.distance(centre));
            }
            // The ball through the surface point and the nearest point, with its centre on the normal.
            let to = near - surface;
            let along = to.dot(inward);
            let touching = if along > 0.0 { to.length_squared() / (2.0 * along) } else { 0.5 * radius };
            radius = touching.min(0.98 * radius);
        }
        self.largest(surface + inward * radius.max(0.0))
    }
}
