//! Maps of joint space, also of objects that have moved.

use std::sync::Arc;

use elbowroom::cell::Cell as Model;
use elbowroom::cspace::{GridAxis, ObstacleModel};
use elbowroom::proximity::{Shape, Sphere};
use elbowroom::query::map::{BlockedCells, MapModel, MapQuery, MapRequest};
use elbowroom::robot::ObjectId;
use elbowroom::spatial::{Pose, Vec3};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::{CHUNK, Rows};
use crate::error::Fault;
use crate::places::objects_at;
use crate::progress::Progress;

/// A robot that is prepared for maps, and the cells that each obstacle blocks; `elbowroom.results.JointMap` has it.
#[pyclass(module = "elbowroom", frozen)]
pub struct MapRecord {
    query: Arc<MapQuery<Arc<Model>>>,
    model: ObstacleModel,
    /// One per object of the cell, in its order.
    objects: Vec<Arc<BlockedCells>>,
    /// The cells of solids that are no objects of the cell.
    seen: Option<Arc<BlockedCells>>,
}

/// Computes the map of a robot, as an object of the package.
pub fn map<'py>(
    py: Python<'py>,
    cell: &Arc<Model>,
    robot: Option<String>,
    model: &str,
    progress: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let MapModel::Solids(model) = model.parse().map_err(|e| Fault::Argument(format!("`model`: {e}")))? else {
        let text = "`model` is \"seeds\", which misses cells\n  write: exact, slices, sphere, spheres=N or box";
        return Err(Fault::Argument(text.into()).into());
    };
    let request = MapRequest { robot, ..MapRequest::default() };
    let progress = Progress::new(py, progress, cell.objects.len(), "objects")?;
    let query = py.detach(|| MapQuery::new(cell.clone(), &request, &|_| ()).map_err(Fault::from))?;
    if query.union([]).is_none() {
        return Err(too_large().into());
    }
    let mut objects = Vec::with_capacity(cell.objects.len());
    for (id, object) in cell.objects.iter().enumerate() {
        let cells = py.detach(|| query.cells_of(ObjectId(id), &object.in_world, model).map_err(Fault::from))?;
        objects.push(Arc::new(cells));
        progress.add(py, 1)?;
        py.check_signals()?;
    }
    progress.end(py)?;
    MapRecord { query: Arc::new(query), model, objects, seen: None }.into_map(py)
}

fn too_large() -> Fault {
    let text = "the map has too many cells for an array\n  write: a larger `step` in [map.ROBOT] of the cell file";
    Fault::Argument(text.into())
}

impl MapRecord {
    fn obstacles(&self) -> impl Iterator<Item = &BlockedCells> {
        self.objects.iter().chain(&self.seen).map(AsRef::as_ref)
    }

    fn is_blocked(&self, q: &[f64]) -> bool {
        // A map without obstacles has limits too.
        let is_inside = self.query.axes().iter().zip(q).all(|(axis, value)| axis.cell(*value).is_some());
        !is_inside || self.obstacles().any(|cells| cells.is_blocked(q))
    }

    /// The map as an object of the package.
    fn into_map(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        let Some(dense) = py.detach(|| self.query.union(self.obstacles())) else {
            return Err(too_large().into());
        };
        let axes = self.query.axes();
        let joints: Vec<&str> = axes.iter().map(GridAxis::joint).collect();
        let centers = |axis: &GridAxis| (0..axis.count()).map(|cell| axis.center(cell)).collect();
        let centers: Vec<_> = axes.iter().map(|axis| PyArray1::from_vec(py, centers(axis))).collect();
        let (blocked, shape) = (PyArray1::from_slice(py, dense.cells()), dense.shape().to_vec());
        let names = self.query.cell().objects.iter().map(|object| object.name.clone());
        let by_object: Vec<_> = names.zip(self.objects.iter().map(|cells| cells.blocked())).collect();
        let robot = self.query.robot().name.clone();
        let joints: Vec<String> = joints.into_iter().map(str::to_owned).collect();
        let make = py.import("elbowroom.results")?.getattr("JointMap")?.getattr("_of")?;
        make.call1((robot, joints, centers, blocked, shape, by_object, self))
    }
}

#[pymethods]
impl MapRecord {
    /// The map with objects at other places, and with spheres that a sensor sees.
    fn moved<'py>(
        &self,
        py: Python<'py>,
        objects: &Bound<'py, PyAny>,
        spheres: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let places = objects_at(self.query.cell(), objects)?;
        let seen = spheres.map(solids).transpose()?;
        let record = py.detach(|| {
            let mut objects = self.objects.clone();
            for (object, in_world) in &places {
                objects[object.0] = Arc::new(self.query.cells_of(*object, in_world, self.model)?);
            }
            let seen = match seen {
                Some(solids) => Some(Arc::new(self.query.cells_of_solids(&solids, self.model)?)),
                None => self.seen.clone(),
            };
            Ok::<_, Fault>(Self { query: self.query.clone(), model: self.model, objects, seen })
        })?;
        record.into_map(py)
    }

    /// Which states are in blocked cells, or outside of the map.
    fn are_blocked<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let (py, axes) = (q.py(), self.query.axes());
        let names: Vec<String> = axes.iter().map(|axis| axis.joint().to_owned()).collect();
        let rows = Rows::of(q, "q", &names)?;
        let mut out = Vec::with_capacity(rows.len());
        for begin in (0..rows.len()).step_by(CHUNK) {
            let values = rows.chunk(begin)?;
            py.detach(|| out.extend(values.chunks_exact(axes.len()).map(|q| self.is_blocked(q))));
            py.check_signals()?;
        }
        Ok(PyArray1::from_vec(py, out))
    }
}

/// Spheres at their centres in the world.
fn solids(value: &Bound<'_, PyAny>) -> Result<Vec<(Shape, Pose)>, Fault> {
    let rows = Rows::of_width(value, "spheres", 4, &|| "(N, 4), float64: x, y, z and the radius, metres".into())?;
    let values = rows.all()?;
    let sphere = |(number, row): (usize, &[f64])| {
        let shape = Shape::Sphere(Sphere { radius: row[3] });
        shape.validate().map_err(|e| {
            Fault::Array(format!("`spheres`: row {number}: {e}\n  write: a radius of 0 or more, metres"))
        })?;
        Ok((shape, Pose::from_translation(Vec3::new(row[0], row[1], row[2]))))
    };
    values.chunks_exact(4).enumerate().map(sphere).collect()
}
