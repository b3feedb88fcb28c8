//! Greedy selection of the outer spheres, followed by removal of redundant spheres and shrinking of the rest.

use elbowroom_spatial::{Aabb, Vec3};

use super::ball::{Ball, ROUNDING_M};
use super::medial_balls::MedialBalls;
use super::placement::PlacedShapes;
use super::surface_voxels::SurfaceVoxels;
use super::uncovered::cover_inside;
use super::voxel_grid::VoxelGrid;
use super::voxel_tree::{VoxelTree, contains_all};

/// The outer spheres of a solid during their selection.
struct CoverSelection<'g, 's> {
    medial: MedialBalls<'g, 's>,
    surface: &'g SurfaceVoxels,
    tree: VoxelTree,
    balls: Vec<Ball>,
    /// Per voxel of the surface: the number of balls that contain its content.
    counts: Vec<u16>,
    /// Voxels found in a ball; reused memory.
    found: Vec<u32>,
}

/// Balls whose union contains all voxels inside, and the content of each voxel of the surface.
///
/// `None` if triangles have NaN or infinite numbers.
pub(super) fn outer_balls(placed: &PlacedShapes, grid: &VoxelGrid, slack_m: f64) -> Option<Vec<Ball>> {
    let medial = MedialBalls::new(placed, grid, slack_m)?;
    let (surface, tree) = (&grid.surface, VoxelTree::new(&grid.surface));
    let counts = vec![0; surface.voxels.len()];
    let mut selection = CoverSelection { medial, surface, tree, balls: Vec::new(), counts, found: Vec::new() };
    selection.cover_surface();
    selection.trim();
    cover_inside(grid, &selection.medial, &mut selection.balls);
    let enlarged = |b: &Ball| Ball { radius: b.radius + placed.chord_error_m, ..*b }.rounded_up();
    Some(selection.balls.iter().map(enlarged).collect())
}

impl CoverSelection<'_, '_> {
    fn cover_surface(&mut self) {
        for voxel in spread(self.surface.voxels.len()) {
            if self.counts[voxel] == 0 {
                let ball = self.best_ball(voxel);
                for &i in &self.found {
                    self.counts[i as usize] = self.counts[i as usize].saturating_add(1);
                }
                self.balls.push(ball);
            }
        }
    }

    /// The best candidate that contains the content of a voxel: the one with the most voxels that no ball contains yet.
    ///
    /// Lists in `found` the voxels that the ball contains.
    fn best_ball(&mut self, voxel: usize) -> Ball {
        let candidates = self.medial.candidates(&self.surface.voxels[voxel]);
        let mut best = None;
        let mut in_best = std::mem::take(&mut self.found);
        for ball in candidates.into_iter().filter(|ball| contains_all(ball, self.surface, voxel)) {
            self.tree.list_in(self.surface, &ball, &mut self.found);
            let gain = self.found.iter().filter(|&&i| self.counts[i as usize] == 0).count();
            if best.is_none_or(|(most, _)| gain > most) {
                best = Some((gain, ball));
                std::mem::swap(&mut in_best, &mut self.found);
            }
        }
        let ball = best.map_or_else(|| self.smallest_ball(voxel), |(_, ball)| ball);
        if best.is_none() {
            self.tree.list_in(self.surface, &ball, &mut in_best);
        }
        self.found = in_best;
        ball
    }

    /// A ball about the content of a voxel.
    fn smallest_ball(&self, voxel: usize) -> Ball {
        let points = self.surface.points(voxel);
        let centre = Aabb::from_points(points.iter().copied()).center();
        let radius = points.iter().map(|p| p.distance(centre)).fold(0.0, f64::max) + 2.0 * ROUNDING_M;
        self.medial.largest(centre).filter(|b| b.radius > radius).unwrap_or(Ball { centre, radius })
    }

    /// Shrinks each ball to the voxels that only it contains, the smallest ball first, and removes balls without any.
    fn trim(&mut self) {
        let mut order: Vec<usize> = (0..self.balls.len()).collect();
        order.sort_by(|&i, &j| self.balls[i].radius.total_cmp(&self.balls[j].radius));
        for i in order {
            let ball = self.balls[i];
            self.tree.list_in(self.surface, &ball, &mut self.found);
            let smaller = Ball { radius: ball.radius.min(self.needed_radius(ball.centre)), ..ball };
            for &voxel in &self.found {
                let is_released = !contains_all(&smaller, self.surface, voxel as usize);
                let count = &mut self.counts[voxel as usize];
                *count = count.saturating_sub(u16::from(is_released));
            }
            self.balls[i] = smaller;
        }
        self.balls.retain(|b| b.radius > 0.0);
    }

    /// Radius that a ball needs for the found voxels that only it contains; 0 without such voxels.
    fn needed_radius(&self, centre: Vec3) -> f64 {
        let alone = self.found.iter().filter(|&&voxel| self.counts[voxel as usize] == 1);
        let points = alone.flat_map(|&voxel| self.surface.points(voxel as usize));
        let largest = points.map(|p| (*p - centre).length_squared()).fold(-1.0, |l, s| if s > l { s } else { l });
        if largest < 0.0 { 0.0 } else { largest.sqrt() + 3.0 * ROUNDING_M }
    }
}

/// All numbers below `n`, in a scattered order that is equal on every call.
fn spread(n: usize) -> impl Iterator<Item = usize> {
    // A multiplier near the golden section that shares no factor with the length visits every number once.
    let mut stride = ((n as f64) * 0.618_033_988_75) as usize | 1;
    while greatest_common_divisor(stride, n) != 1 {
        stride += 2;
    }
    (0..n).map(move |i| (i * stride) % n)
}

fn greatest_common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { greatest_common_divisor(b, a % b) }
}
