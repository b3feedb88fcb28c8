//! Balls for the voxels inside that no ball contains yet.

use elbowroom_spatial::Vec3;

use super::ball::{Ball, ROUNDING_M};
use super::medial_balls::MedialBalls;
use super::voxel_grid::VoxelGrid;

struct Uncovered<'g, 's, 'b> {
    grid: &'g VoxelGrid,
    medial: &'g MedialBalls<'g, 's>,
    balls: &'b mut Vec<Ball>,
}

/// Adds balls until every voxel inside is in a ball.
pub(super) fn cover_inside(grid: &VoxelGrid, medial: &MedialBalls, balls: &mut Vec<Ball>) {
    let size = grid.counts.iter().fold(1, |size, &n| size.max(n)).next_power_of_two();
    // Large balls contain the most voxels.
    balls.sort_by(|a, b| b.radius.total_cmp(&a.radius));
    let near: Vec<u32> = (0..balls.len() as u32).collect();
    Uncovered { grid, medial, balls }.cover_cube([0; 3], size, &near);
}

impl Uncovered<'_, '_, '_> {
    /// Covers the voxels inside that lie in a cube.
    ///
    /// `near` has the balls that touch the cube, without the balls added since.
    fn cover_cube(&mut self, cell: [usize; 3], size: usize, near: &[u32]) {
        if !self.grid.inside.any_in_cube(cell, size) {
            return;
        }
        let half = Vec3::splat(0.5 * self.grid.lattice.step_m * size as f64);
        let centre = self.grid.lattice.corner(cell.map(|c| c as u32)) + half;
        if near.iter().any(|&i| self.balls[i as usize].contains_box(centre, half)) {
            return;
        }
        if size == 1 {
            let smallest = Ball { centre, radius: half.length() + 2.0 * ROUNDING_M };
            let largest = self.medial.largest(centre).filter(|b| b.contains_box(centre, half));
            self.balls.push(largest.unwrap_or(smallest));
            return;
        }
        let touches = |ball: &Ball| {
            let beyond = ((ball.centre - centre).abs() - half).max(Vec3::ZERO);
            beyond.length_squared() <= ball.radius * ball.radius
        };
        let mut near: Vec<u32> = near.iter().copied().filter(|&i| touches(&self.balls[i as usize])).collect();
        for corner in 0..8 {
            let before = self.balls.len();
            self.cover_cube([0, 1, 2].map(|axis| cell[axis] + (corner >> axis & 1) * (size / 2)), size / 2, &near);
            near.extend(before as u32..self.balls.len() as u32);
        }
    }
}
