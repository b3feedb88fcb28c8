//! A tree of boxes over the surface voxels, which finds the voxels in a ball.

use elbowroom_spatial::Aabb;

use super::ball::{Ball, ROUNDING_M};
use super::surface_voxels::SurfaceVoxels;

/// Children of a node.
const FAN_OUT: usize = 8;

/// Boxes over runs of voxels, and over runs of such boxes.
pub(super) struct VoxelTree {
    /// Levels of boxes: the first has a box per run of voxels, each further one a box per run of the previous level.
    ///
    /// The last has one run.
    levels: Vec<Vec<Aabb>>,
    voxels: usize,
}

impl VoxelTree {
    pub fn new(surface: &SurfaceVoxels) -> Self {
        let voxels: Vec<usize> = (0..surface.voxels.len()).collect();
        let around = |run: &[usize]| Aabb::from_points(run.iter().flat_map(|&i| surface.points(i).iter().copied()));
        let mut levels = vec![voxels.chunks(FAN_OUT).map(around).collect::<Vec<_>>()];
        while let Some(last) = levels.last().filter(|level| level.len() > FAN_OUT) {
            let union = |run: &[Aabb]| run.iter().fold(run[0], |all, b| all.union(b));
            levels.push(last.chunks(FAN_OUT).map(union).collect());
        }
        Self { levels, voxels: voxels.len() }
    }

    /// Lists the voxels whose points are all in a ball, with room for rounding errors.
    pub fn list_in(&self, surface: &SurfaceVoxels, ball: &Ball, found: &mut Vec<u32>) {
        found.clear();
        if ball.radius > ROUNDING_M {
            let top = self.levels.len() - 1;
            self.descend(surface, ball, top, 0..self.levels[top].len(), found);
        }
    }

    fn descend(
        &self,
        surface: &SurfaceVoxels,
        ball: &Ball,
        level: usize,
        boxes: std::ops::Range<usize>,
        found: &mut Vec<u32>,
    ) {
        for i in boxes {
            if !touches(&self.levels[level][i], ball) {
                continue;
            }
            let below = if level == 0 { self.voxels } else { self.levels[level - 1].len() };
            let children = i * FAN_OUT..((i + 1) * FAN_OUT).min(below);
            if level > 0 {
                self.descend(surface, ball, level - 1, children, found);
            } else {
                found.extend(children.filter(|&voxel| contains_all(ball, surface, voxel)).map(|voxel| voxel as u32));
            }
        }
    }
}

/// True if a ball contains the content of a voxel, with room for rounding errors.
pub(super) fn contains_all(ball: &Ball, surface: &SurfaceVoxels, voxel: usize) -> bool {
    let square = (ball.radius - ROUNDING_M).powi(2);
    ball.radius > ROUNDING_M && surface.points(voxel).iter().all(|&p| (p - ball.centre).length_squared() <= square)
}

fn touches(bounds: &Aabb, ball: &Ball) -> bool {
    let beyond = |axis: usize| {
        let below = bounds.min[axis] - ball.centre[axis];
        let above = ball.centre[axis] - bounds.max[axis];
        // Faster than `max`, which handles NaN.
        let outside = if below > above { below } else { above };
        if outside > 0.0 { outside * outside } else { 0.0 }
    };
    beyond(0) + beyond(1) + beyond(2) <= ball.radius * ball.radius
}
