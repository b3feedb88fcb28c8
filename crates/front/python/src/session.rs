//! What sessions have in common: their cell with its scene, poses, overrides.

use std::sync::Arc;

use elbowroom::cell::Cell as Model;
use elbowroom::formats::suggest;
use elbowroom::scene::Scene;
use elbowroom::spatial::{Pose, Rotation, Vec3};
use pyo3::prelude::*;

use crate::arrays::Rows;
use crate::error::Fault;
use crate::progress::Progress;

/// Steps between two checks whether a signal has arrived: a step takes a few milliseconds at most.
const BETWEEN_SIGNALS: usize = 16;

/// A cell with its scene, and the index of the table in it that the session is of.
pub struct Surroundings {
    pub cell: Arc<Model>,
    pub scene: Scene,
    pub index: usize,
}

impl Surroundings {
    pub fn of(cell: &Arc<Model>, index: usize) -> Result<Self, Fault> {
        Ok(Self { cell: cell.clone(), scene: cell.scene_of_guidance()?, index })
    }
}

/// A step has panicked, and its session is in an unknown state.
pub fn broken() -> Fault {
    let text = "a step has failed, and where the robot is now is not known\n  write: reset()";
    Fault::Argument(text.into())
}

/// The index of what has a name; without a name that of the only one. `what` is the word for the table in the cell file.
pub fn named(what: &str, known: &[&str], name: Option<&str>) -> Result<usize, Fault> {
    let words = what.replace('_', " ");
    let all = || known.iter().copied();
    let text = match name {
        None if known.len() == 1 => return Ok(0),
        _ if known.is_empty() => format!("the cell has no {words}\n  write: [{what}.NAME] in the cell file"),
        None => format!("the cell has {} {words}s\n  write: {}", known.len(), suggest::hint("", all())),
        Some(name) => match known.iter().position(|known| *known == name) {
            Some(index) => return Ok(index),
            None => format!("no {words} is called \"{name}\"\n  write: {}", suggest::hint(name, all())),
        },
    };
    Err(Fault::Argument(text))
}

/// Makes the steps of all inputs part by part: other threads of Python run during a part, and between two the progress is told and
/// signals end the call.
pub fn in_parts<T: Sync>(
    py: Python<'_>,
    inputs: &[T],
    progress: bool,
    mut steps: impl FnMut(&[T]) -> Result<(), Fault> + Send,
) -> PyResult<()> {
    let progress = Progress::new(py, progress, inputs.len(), "steps")?;
    for part in inputs.chunks(BETWEEN_SIGNALS) {
        py.detach(|| steps(part))?;
        progress.add(py, part.len())?;
        py.check_signals()?;
    }
    progress.end(py)
}

/// An override from 0 to 1.
pub fn share(speed_override: f64) -> Result<f64, Fault> {
    if (0.0..=1.0).contains(&speed_override) {
        return Ok(speed_override);
    }
    Err(Fault::Argument(format!("`speed_override` is {speed_override}\n  write: a number from 0 to 1")))
}

/// Poses from rows `x, y, z, quaternion x, y, z, w`.
pub fn poses_of_rows(poses: &Bound<'_, PyAny>) -> Result<Vec<Pose>, Fault> {
    let wanted = || "(N, 7), float64: x, y, z, quaternion x, y, z, w".to_owned();
    let values = Rows::of_width(poses, "poses", 7, &wanted)?.all()?;
    values.chunks_exact(7).enumerate().map(|(number, row)| pose(number, row)).collect()
}

/// The pose of a row of seven values.
fn pose(number: usize, row: &[f64]) -> Result<Pose, Fault> {
    let rotation = Rotation::from_quaternion_xyzw([row[3], row[4], row[5], row[6]]);
    let rotation = rotation.ok_or_else(|| {
        Fault::Array(format!("`poses`: row {number} has a quaternion of length 0\n  write: one of length 1"))
    })?;
    Ok(Pose::new(rotation, Vec3::new(row[0], row[1], row[2])))
}
