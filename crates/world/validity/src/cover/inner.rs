//! Inner spheres: balls in the solid, the largest first, far from each other.

use super::ball::{Ball, ROUNDING_M};
use super::placement::PlacedShapes;
use super::voxel_grid::VoxelGrid;

/// Inner spheres of one cover.
const MAX_INNER: usize = 24;
/// Candidates that are measured.
const CANDIDATES: usize = 600;
/// A ball whose centre is nearer to that of a larger one than this share of the larger radius adds little.
const LEAST_SPACING: f64 = 0.6;
/// Smaller balls prove little, m.
const LEAST_RADIUS_M: f64 = 0.004;

/// Balls in the closed shapes.
pub(super) fn inner_balls(placed: &PlacedShapes, grid: &VoxelGrid) -> Vec<Ball> {
    let stride = grid.inside.len().div_ceil(CANDIDATES).max(1);
    let mut balls: Vec<Ball> = grid
        .inside
        .iter()
        .step_by(stride)
        .map(|cell| grid.centre(cell))
        .map(|centre| Ball { centre, radius: placed.depth_m(centre) - 2.0 * ROUNDING_M })
        .filter(|b| b.radius > LEAST_RADIUS_M)
        .collect();
    balls.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    let mut chosen: Vec<Ball> = Vec::new();
    for ball in balls {
        if chosen.len() == MAX_INNER {
            break;
        }
        if chosen.iter().all(|c| c.centre.distance(ball.centre) > LEAST_SPACING * c.radius) {
            chosen.push(ball);
        }
    }
    chosen
}
