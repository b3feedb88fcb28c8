//! Cells: runs, and maps of joint space.

use std::path::PathBuf;
use std::sync::Arc;

use elbowroom::cell::{Cell as Model, CellRobot};
use elbowroom::kinematics::{ChainState, LinkId};
use elbowroom::sim::RunOptions;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PySlice};

use crate::arrays::Rows;
use crate::error::Fault;
use crate::matrix::{matrix, values};
use crate::motion::motions_of;
use crate::places::robot_named;
use crate::rows::{map_rows, shaped};
use crate::run::run;
use crate::{joint_map, mesh, page};

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

    /// The names of the joints of all robots, `robot.joint`, in the order of the columns of states.
    #[getter]
    fn joints(&self) -> Vec<String> {
        joints_of(&self.model.robots)
    }

    /// The names of the joints of a robot, as a `Trajectory` of it has them.
    fn joints_of(&self, robot: &str) -> PyResult<Vec<String>> {
        Ok(self.model.robots[robot_named(&self.model, robot)?.0].joint_names())
    }

    /// The columns that a robot has in a state, as a slice: `q[:, cell.columns("left")]`.
    fn columns<'py>(&self, py: Python<'py>, robot: &str) -> PyResult<Bound<'py, PySlice>> {
        let index = robot_named(&self.model, robot)?.0;
        let count = |robot: &CellRobot| robot.robot.chain.dof();
        let begin: usize = self.model.robots[..index].iter().map(count).sum();
        let ends =
            [begin, begin + count(&self.model.robots[index])].map(|end| isize::try_from(end).unwrap_or(isize::MAX));
        Ok(PySlice::new(py, ends[0], ends[1], 1))
    }

    /// The state at the start, `(joints,)`, rad or m.
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.model.robots.iter().flat_map(|robot| robot.start.iter().copied()).collect())
    }

    /// The poses of the objects in the world at the start, 4x4 arrays by name.
    #[getter]
    fn objects<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let poses = PyDict::new(py);
        for object in &self.model.objects {
            poses.set_item(&object.name, matrix(py, &object.in_world)?)?;
        }
        Ok(poses)
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
    fn run<'py>(slf: &Bound<'py, Self>, monitor: bool, avoidance: bool, repeat: i64) -> PyResult<Bound<'py, PyAny>> {
        let repeat = u32::try_from(repeat).ok().filter(|repeat| *repeat > 0).ok_or_else(|| {
            Fault::Argument(format!("`repeat` is {repeat}\n  write: how often the programs run, 1 or more"))
        })?;
        let options = RunOptions { apply_override: monitor, avoidance, repeat, ..RunOptions::default() };
        run(slf, &slf.get().model, &options)
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

    /// Compute the poses of all links.
    ///
    /// Parameters
    /// ----------
    /// q
    ///     `(N, joints)`: the values of `joints`.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Per link, `robot/link`, an array `(N, 4, 4)`: its frame in the world, metres.
    fn fk<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
        let (py, rows) = (q.py(), Rows::of(q, "q", &self.joints())?);
        let robots = &self.model.robots;
        let links: usize = robots.iter().map(|robot| robot.robot.chain.links().len()).sum();
        let worker = || robots.iter().map(|robot| ChainState::new(&robot.robot.chain)).collect::<Vec<_>>();
        let all = map_rows(py, &rows, 16 * links, worker, |states, q, out| {
            let (mut joints, mut poses) = (q, out.chunks_exact_mut(16));
            for (robot, state) in robots.iter().zip(states) {
                let (own, others) = joints.split_at(state.q.len());
                joints = others;
                state.q.copy_from_slice(own);
                robot.robot.chain.forward(state);
                for (link, out) in (0..robot.robot.chain.links().len()).zip(&mut poses) {
                    let pose = robot.base_in_world * state.link_in_root(LinkId(link));
                    out.copy_from_slice(&values(&pose));
                }
            }
        })?;
        let poses = shaped(&all, [rows.len(), links, 4, 4])?;
        let names = robots
            .iter()
            .flat_map(|robot| robot.robot.chain.links().iter().map(move |link| format!("{}/{link}", robot.name)));
        let by_name = PyDict::new(py);
        for (number, name) in names.enumerate() {
            by_name.set_item(name, poses.get_item((PySlice::full(py), number))?)?;
        }
        Ok(by_name)
    }

    /// The surfaces of links and objects.
    ///
    /// Returns
    /// -------
    /// dict
    ///     The `Mesh` of each link, `robot/link`, with tool and load, in the frame of the link; that of each object in its own. A
    ///     half-space is a square.
    fn meshes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        mesh::of_cell(py, &self.model)
    }

    /// Return the cell as a `trimesh.Scene`, with a node per link, `robot/link`, and per object.
    ///
    /// Parameters
    /// ----------
    /// q
    ///     `(joints,)`: the values of `joints`; default: `start`.
    #[pyo3(signature = (q=None))]
    fn to_trimesh<'py>(slf: &Bound<'py, Self>, q: Option<&Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("elbowroom.interop")?.getattr("trimesh_of_cell")?.call1((slf, q))
    }

    /// Log the scene to Rerun, whose package is `rerun-sdk`.
    ///
    /// Parameters
    /// ----------
    /// motions
    ///     As for `page`.
    /// stream
    ///     A `rerun.RecordingStream`; default: that of the thread.
    #[pyo3(signature = (motions=None, stream=None))]
    fn to_rerun(
        slf: &Bound<'_, Self>,
        motions: Option<&Bound<'_, PyAny>>,
        stream: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        slf.py().import("elbowroom.rerun_log")?.getattr("log_cell")?.call1((slf, motions, stream))?;
        Ok(())
    }

    /// The cell as an HTML page that needs no network: the scene in 3-D.
    ///
    /// Parameters
    /// ----------
    /// motions
    ///     The `Trajectory` of each robot that moves, by its name; the others are at their start.
    #[pyo3(signature = (motions=None))]
    fn page(&self, py: Python<'_>, motions: Option<&Bound<'_, PyAny>>) -> PyResult<String> {
        let motions = motions.map_or(Ok(Vec::new()), |motions| motions_of(&self.model, motions))?;
        let label = if motions.is_empty() { "at the start" } else { "motion" };
        Ok(py.detach(|| page::of_motions(&self.model, label, motions))?)
    }

    fn _repr_html_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("elbowroom.pages")?.getattr("frame")?.call1((self.page(py, None)?,))
    }

    fn __repr__(&self) -> String {
        format!("Cell({:?}: {} robots, {} objects)", self.name(), self.model.robots.len(), self.model.objects.len())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("elbowroom.pickles")?.getattr("reduced_cell")?.call1((&self.path,))
    }
}

/// The names of the joints of robots that stand side by side in a state: `robot.joint`.
pub fn joints_of<'c>(robots: impl IntoIterator<Item = &'c CellRobot>) -> Vec<String> {
    let of = |robot: &CellRobot| {
        let name = robot.name.clone();
        robot.joint_names().into_iter().map(move |joint| format!("{name}.{joint}"))
    };
    robots.into_iter().flat_map(of).collect()
}
