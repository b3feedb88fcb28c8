//! Cells: runs, and maps of joint space.

use std::path::PathBuf;
use std::sync::Arc;

use elbowroom::cell::Cell as Model;
use elbowroom::sim::RunOptions;
use pyo3::prelude::*;

use crate::error::Fault;
use crate::run::run;
use crate::{joint_map, page};

/// A cell file and what it describes: robots, objects, regions, programs.
///
/// Examples
/// --------
/// >>> import elbowroom as er
/// >>> cell = er.Cell.load("examples/figure12/cell.toml")
/// >>> cell.robots
/// ['ns16']
#[pyclass(module = "elbowroom", frozen, weakref)]
pub struct Cell {
    pub(crate) model: Arc<Model>,
    path: PathBuf,
}

#[pymethods]
impl Cell {
    /// Load a cell file.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     With file, line, and what to write instead.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let model = py.detach(|| Model::load(&path).map_err(Fault::from))?;
        // The present folder may be another one when it is pickled.
        let path = std::path::absolute(&path).unwrap_or(path);
        Ok(Self { model: Arc::new(model), path })
    }

    /// The name of the cell.
    #[getter]
    fn name(&self) -> &str {
        &self.model.name
    }

    /// The file.
    #[getter]
    fn path(&self) -> &PathBuf {
        &self.path
    }

    /// The names of the robots, in the order of the file.
    #[getter]
    fn robots(&self) -> Vec<&str> {
        self.model.robots.iter().map(|robot| robot.name.as_str()).collect()
    }

    /// Remarks about the file.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.model.warnings.iter().map(ToString::to_string).collect()
    }

    /// Run the programs in simulated time under the monitors.
    ///
    /// Parameters
    /// ----------
    /// monitor
    ///     Whether the monitors limit the speed override; otherwise they observe.
    /// avoidance
    ///     Whether robots evade; otherwise all follow their programs.
    /// repeat
    ///     How often the programs run.
    ///
    /// Returns
    /// -------
    /// Run
    ///
    /// Raises
    /// ------
    /// FileError
    ///     If a program cannot be carried out.
    #[pyo3(signature = (*, monitor=true, avoidance=true, repeat=1))]
    fn run<'py>(&self, py: Python<'py>, monitor: bool, avoidance: bool, repeat: i64) -> PyResult<Bound<'py, PyAny>> {
        let repeat = u32::try_from(repeat).ok().filter(|repeat| *repeat > 0).ok_or_else(|| {
            Fault::Argument(format!("`repeat` is {repeat}\n  write: how often the programs run, 1 or more"))
        })?;
        let options = RunOptions { apply_override: monitor, avoidance, repeat, ..RunOptions::default() };
        run(py, &self.model, &options)
    }

    /// Compute the cells of joint space that objects block.
    ///
    /// Parameters
    /// ----------
    /// robot
    ///     The robot; optional if there is only one, or only one `[map.ROBOT]`.
    /// model
    ///     Model of the objects: `"exact"`, `"slices"`, `"sphere"`, `"spheres=8"` or `"box"`. No model misses a blocked cell.
    /// progress
    ///     Whether to say on standard error how much is done.
    ///
    /// Returns
    /// -------
    /// JointMap
    #[pyo3(signature = (robot=None, *, model="exact", progress=false))]
    fn map<'py>(
        &self,
        py: Python<'py>,
        robot: Option<String>,
        model: &str,
        progress: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        joint_map::map(py, &self.model, robot, model, progress)
    }

    /// The cell at its start as an HTML page that needs no network: the scene in 3-D.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        Ok(py.detach(|| page::of_motion(&self.model, "at the start", None))?)
    }

    fn _repr_html_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("elbowroom.pages")?.getattr("frame")?.call1((self.page(py)?,))
    }

    fn __repr__(&self) -> String {
        format!("Cell({:?}: {} robots, {} objects)", self.name(), self.model.robots.len(), self.model.objects.len())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("elbowroom.pickles")?.getattr("reduced_cell")?.call1((&self.path,))
    }
}
