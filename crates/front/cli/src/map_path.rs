//! A path over the slices of a map.

use std::path::Path;

use elbowroom::cell::{Cell, QueryModel};
use elbowroom::query::map::CellMap;

use crate::output::{Failure, note};
use crate::states;

/// Joint values of a map's axes, and how many of them are in blocked cells.
pub(crate) struct MapPath {
    pub(crate) rows: Vec<Vec<f64>>,
    pub(crate) blocked: usize,
}

impl MapPath {
    /// Reads the file that `plan --out` writes, or any states of the map's robot.
    pub(crate) fn read(path: &Path, cell: &Cell, map: &CellMap) -> Result<Self, Failure> {
        // The map names a robot of the cell.
        let robot = cell.robots.iter().find(|robot| robot.name == map.robot).unwrap_or(&cell.robots[0]);
        let states = states::read(path, &QueryModel::of_robot(&cell.file, robot.robot.clone()))?;
        states.warnings.iter().for_each(|w| note(format_args!("warning: {w}")));
        let names = robot.joint_names();
        let axes: Vec<usize> =
            map.axes.iter().filter_map(|axis| names.iter().position(|n| n == axis.joint())).collect();
        let of_axes = |q: &[f64]| axes.iter().map(|&joint| q[joint]).collect::<Vec<f64>>();
        let rows: Vec<Vec<f64>> =
            (0..states.len()).flat_map(|index| states.of(index)).map(|(_, q)| of_axes(q)).collect();
        let is_blocked = |q: &&Vec<f64>| map.obstacles.iter().any(|o| o.blocks.is_blocked(q));
        let blocked = rows.iter().filter(is_blocked).count();
        Ok(Self { rows, blocked })
    }
}
