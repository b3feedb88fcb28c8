//! Objects at other places than in the file.

use std::collections::BTreeMap;

use elbowroom::cell::Cell;
use elbowroom::formats::suggest;
use elbowroom::robot::ObjectId;
use elbowroom::spatial::Pose;
use pyo3::prelude::*;

use crate::error::Fault;
use crate::robot::pose_of;

/// Poses by the names of objects.
pub type Places<'py> = BTreeMap<String, Bound<'py, PyAny>>;

/// Objects of a cell with their poses in the world.
pub fn objects_at(cell: &Cell, places: Places<'_>) -> Result<Vec<(ObjectId, Pose)>, Fault> {
    let names = || cell.objects.iter().map(|object| object.name.as_str());
    let place = |(name, pose): (String, Bound<'_, PyAny>)| {
        let object = names().position(|known| known == name).ok_or_else(|| {
            Fault::Argument(format!("the cell has no object \"{name}\"\n  write: {}", suggest::hint(&name, names())))
        })?;
        Ok((ObjectId(object), pose_of(&pose)?))
    };
    places.into_iter().map(place).collect()
}
