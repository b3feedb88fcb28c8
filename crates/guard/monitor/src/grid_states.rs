//! The present cells of the grids of a robot.

use elbowroom_kinematics::JointKind;

use crate::placement::Placement;
use crate::{Configuration, Grid, GridSpace};

/// The present cell of each grid of a monitor.
#[derive(Debug)]
pub(crate) struct GridStates {
    cells: Vec<u32>,
    /// Coordinates of the grid that is evaluated; as long as the longest list of axes.
    coordinates: Vec<f64>,
    /// The digital outputs, one bit each.
    pub(crate) bits: u64,
}

impl GridStates {
    pub(crate) fn new(grids: &[Grid]) -> Self {
        let most = grids.iter().map(|grid| grid.axes.len()).max().unwrap_or(0);
        Self { cells: vec![0; grids.len()], coordinates: vec![0.0; most.max(3)], bits: 0 }
    }

    /// Finds the cells of the robot where it is now.
    pub(crate) fn update(&mut self, config: &Configuration, now: &Placement) {
        let Self { cells, coordinates, bits } = self;
        *bits = 0;
        for (grid, cell) in config.grids.iter().zip(cells) {
            *cell = if locate(grid, config, now, coordinates) { grid.cell_at(coordinates, *cell) } else { 0 };
            *bits |= u64::from(*cell) << grid.output;
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

/// Writes the robot's coordinates in the space of a grid; returns false if the robot has none, because its tool is
/// not mounted.
fn locate(grid: &Grid, config: &Configuration, now: &Placement, coordinates: &mut [f64]) -> bool {
    match &grid.space {
        GridSpace::Tcp { frame_in_world } => {
            let volumes = config.volumes.iter().enumerate();
            let tcp = volumes.filter(|(_, v)| v.part.is_tcp()).find(|(i, _)| now.attached.contains(*i));
            let Some((tcp, _)) = tcp else { return false };
            let p = frame_in_world.inverse().transform_point(now.volume_in_world[tcp].translation);
            coordinates[..3].copy_from_slice(&p.to_array());
        }
        GridSpace::Joints(joints) => {
            for ((coordinate, q), axis) in coordinates.iter_mut().zip(joints).zip(&grid.axes) {
                let joint = config.chain.active_joints()[*q];
                let turns = config.chain.joints()[joint.0].kind == JointKind::Continuous;
                let value = now.chain.q[*q];
                *coordinate =
                    if turns { axis.from + (value - axis.from).rem_euclid(std::f64::consts::TAU) } else { value };
            }
        }
    }
    true
}
