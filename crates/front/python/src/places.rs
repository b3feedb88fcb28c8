//! Objects at other places than in the file, and robots by their names.

use elbowroom::cell::Cell;
use elbowroom::formats::suggest;
use elbowroom::robot::{ObjectId, RobotId};
use elbowroom::spatial::Pose;
use pyo3::prelude::*;
use pyo3::types::PyMapping;

use crate::error::Fault;
use crate::robot::pose_of;

/// Objects of a cell with their poses in the world: a mapping from their names.
pub fn objects_at(cell: &Cell, places: &Bound<'_, PyAny>) -> Result<Vec<(ObjectId, Pose)>, Fault> {
    let Ok(places) = places.cast::<PyMapping>() else {
        let class = places.get_type().name().map(|n| n.to_string()).unwrap_or_default();
        return Err(Fault::Argument(format!("`objects` is a {class}\n  write: {{\"name\": pose}}")));
    };
    let names = || cell.objects.iter().map(|object| object.name.as_str());
    let place = |item: Bound<'_, PyAny>| {
        let (name, pose): (String, Bound<'_, PyAny>) = item.extract()?;
        let object = names().position(|known| known == name).ok_or_else(|| {
            Fault::Argument(format!("the cell has no object \"{name}\"\n  write: {}", suggest::hint(&name, names())))
        })?;
        Ok((ObjectId(object), pose_of(&pose)?))
    };
    places.items()?.iter().map(place).collect()
}

/// The robot of a cell with a name.
pub fn robot_named(cell: &Cell, name: &str) -> Result<RobotId, Fault> {
    let names: Vec<&str> = cell.robots.iter().map(|robot| robot.name.as_str()).collect();
    names.iter().position(|known| *known == name).map(RobotId).ok_or_else(|| Fault::no_robot(name, &names))
}
