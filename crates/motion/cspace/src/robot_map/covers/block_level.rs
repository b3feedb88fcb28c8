//! Boxes of joint space of one size.

use elbowroom_spatial::Pose;

use super::axis_roles::AxisRoles;
use super::step_chain::StepChain;
use crate::Grid;

/// A frame in single precision: the columns of its rotation, and its origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub columns: [[f32; 3]; 3],
    pub origin: [f32; 3],
}

impl Frame {
    pub fn new(pose: &Pose) -> Self {
        let rotation = pose.rotation;
        Self {
            columns: [rotation.x_axis(), rotation.y_axis(), rotation.z_axis()].map(single),
            origin: single(pose.translation),
        }
    }
}

/// Boxes of `2^level` cells along every axis; along the axis in lanes, one lane is one box.
#[derive(Debug, Clone)]
pub(super) struct BlockLevel {
    /// Half widths of a box, rad or m, per axis of the map.
    pub half: [f64; 3],
    /// Number of boxes along each of the two other axes.
    pub blocks: [usize; 2],
    /// Frames of all steps, relative to the first step, at the centre of each box.
    frames: Vec<Frame>,
    steps: usize,
}

impl BlockLevel {
    /// Creates boxes for links that are moved by the other axes selected in `uses`.
    pub fn new(level: u32, grid: &Grid, roles: &AxisRoles, uses: [bool; 2], steps: &StepChain) -> Self {
        let size = 1 << level;
        // A value on the border of a cell belongs to the cell.
        let half = [0, 1, 2].map(|axis| grid.axes()[axis].step() * (0.5 * size as f64 + 1e-6));
        let counts = roles.other_counts();
        let blocks = [0, 1].map(|k| if uses[k] { counts[k].div_ceil(size) } else { 1 });
        let mut frames = Vec::with_capacity(blocks[0] * blocks[1] * steps.steps.len());
        for i in 0..blocks[0] {
            for j in 0..blocks[1] {
                let mut values = [0.0; 3];
                for (at, &axis) in [i, j].iter().zip(&roles.others) {
                    let axis_cells = &grid.axes()[axis];
                    values[axis] = axis_cells.border(at * size) + 0.5 * size as f64 * axis_cells.step();
                }
                frames.extend(steps.seen_from_first(&values).iter().map(Frame::new));
            }
        }
        Self { half, blocks, frames, steps: steps.steps.len() }
    }

    /// Frames of all steps at the centre of a box.
    #[inline]
    pub fn frames(&self, block: [usize; 2]) -> &[Frame] {
        let first = (block[0] * self.blocks[1] + block[1]) * self.steps;
        &self.frames[first..first + self.steps]
    }
}

pub(super) fn single(v: elbowroom_spatial::Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}
