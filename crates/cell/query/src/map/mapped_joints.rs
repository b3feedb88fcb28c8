//! The three joints of a robot's map, and its cells.

use elbowroom_cell::{Cell, CellRobot};
use elbowroom_cspace::{Grid, GridAxis};
use elbowroom_formats::Diagnostic;

use super::map_axes::{axes, select_map};

/// Largest difference to the start of a joint that is not in the map, rad or m.
const HELD: f64 = 1e-9;

/// The joints of a map of three joints.
#[derive(Debug, Clone)]
pub(crate) struct MappedJoints {
    /// Indices among the robot's joint values.
    pub joints: [usize; 3],
    pub grid: Grid,
}

impl MappedJoints {
    /// Finds the three map joints of a robot of a cell. `otherwise` names an alternative to write, if there is one.
    ///
    /// # Errors
    /// An error if the map does not have three joints, or has too many cells.
    pub fn of(
        cell: &Cell,
        robot: &CellRobot,
        (purpose, otherwise): (&str, Option<&str>),
        warnings: &mut Vec<Diagnostic>,
    ) -> Result<Self, Diagnostic> {
        let (_, _, spec) = select_map(cell, Some(&robot.name))?;
        let wrong = |what: String, hint: String| {
            Diagnostic::new(&cell.file, spec.line, format!("the map of robot \"{}\" {what}", robot.name)).hint(hint)
        };
        let names = robot.joint_names();
        let joints = <[usize; 3]>::try_from(&spec.joints[..]).map_err(|_| {
            let three = names
                .get(..3)
                .map(|three| format!("joints = [\"{}\"]   (in [map.{}])", three.join("\", \""), robot.name));
            let hints: Vec<String> = three.into_iter().chain(otherwise.map(str::to_owned)).collect();
            wrong(format!("has {} joints: {purpose} need 3", spec.joints.len()), hints.join(", or "))
        })?;
        let (axes, _) = axes(cell, robot, &spec, warnings)?;
        let axes = <[GridAxis; 3]>::try_from(axes)
            .map_err(|axes| wrong(format!("has {} axes: {purpose} need 3", axes.len()), String::new()))?;
        let grid = Grid::new(axes).map_err(|e| wrong(format!("is too large: {e}"), "step = 5   (larger)".into()))?;
        Ok(Self { joints, grid })
    }

    /// The first joint that is not in the map and that a goal moves.
    pub fn moved_otherwise(&self, from: &[f64], goal: &[f64]) -> Option<usize> {
        (0..goal.len()).find(|j| !self.joints.contains(j) && (goal[*j] - from[*j]).abs() > HELD)
    }

    /// The values of the joints in the map.
    pub fn of_whole(&self, q: &[f64]) -> [f64; 3] {
        self.joints.map(|j| q[j])
    }
}
