//! The present cells of the grids of a robot.

use std::f64::consts::TAU;

use crate::grid::Coordinate;
use crate::placement::Placement;
use crate::{Configuration, GridSpace, OutputGrid};

/// The present cell of each grid of a monitor.
#[derive(Debug)]
pub(crate) struct GridStates {
    cells: Vec<u32>,
    /// The digital outputs, one bit each.
    pub(crate) bits: u64,
}

impl GridStates {
    pub(crate) fn new(config: &Configuration) -> Self {
        Self { cells: vec![0; config.grids.len()], bits: 0 }
    }

    /// Finds the cells of the robot where it is now.
    pub(crate) fn update(&mut self, config: &Configuration, now: &Placement) {
        self.bits = 0;
        for (grid, cell) in config.grids.iter().zip(&mut self.cells) {
            *cell = cell_of(grid, config, now, *cell);
            self.bits |= u64::from(*cell) << grid.output;
        }
    }

    /// Takes over the cells of the former monitor of the same robot.
    pub(crate) fn continue_from(&mut self, former: &Self) {
        if self.cells.len() == former.cells.len() {
            self.cells.copy_from_slice(&former.cells);
            self.bits = former.bits;
        }
    }
}

/// The cell of the robot; 0 if no tool is mounted.
fn cell_of(grid: &OutputGrid, config: &Configuration, now: &Placement, former: u32) -> u32 {
    match &grid.space {
        GridSpace::Tcp { frame_in_world } => {
            let Some(tcp) = now.tcp() else { return 0 };
            let p = frame_in_world.inverse_transform_point(now.volume_in_world[tcp.0].translation);
            grid.cell(p.to_array().into_iter().map(|at| Coordinate { at, turn: 0.0 }), former)
        }
        GridSpace::Joints(joints) => {
            let turn = |q: usize| if config.turns(q) { TAU } else { 0.0 };
            grid.cell(joints.iter().map(|q| Coordinate { at: now.chain.q[*q], turn: turn(*q) }), former)
        }
    }
}
