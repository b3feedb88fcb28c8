//! Inner spheres: balls in the solid, the largest first, far from each other.

use super::ball::{Ball, ROUNDING_M};
use super::placement::PlacedShapes;
use super::voxel_grid::VoxelGrid;

/// Largest number of inner spheres of one cover.
const MAX_INNER: usize = 24;
/// Largest number of candidates that are measured.
const CANDIDATES: usize = 600;
/// Least distance of a ball's centre from the centre of a larger ball, as a fraction of the larger radius.
///
/// Nearer balls add little.
const LEAST_SPACING: f64 = 0.6;
/// Least radius, m. Smaller balls prove little.
const LEAST_RADIUS_M: f64 = 0.004;

/// Selects balls in the closed shapes.
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
