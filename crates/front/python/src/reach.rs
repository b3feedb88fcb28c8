//! Targets that a robot reaches, from any place of its base.

use std::num::NonZeroUsize;

use elbowroom::cell::QueryModel;
use elbowroom::query::{self, ReachTarget, plan};
use elbowroom::robot::RobotId;
use elbowroom::spatial::{Pose, Rotation, Vec3};
use numpy::{PyArray1, PyArray2, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::Rows;
use crate::cell::Cell;
use crate::error::Fault;
use crate::matrix::matrix;
use crate::progress::Progress;
use crate::robot::{Robot, joint_names, pose_of};
use crate::rows::shaped;

/// Targets between two looks at the signals.
const CHUNK: usize = 4096;
/// Most turns about an axis that are tried.
const MOST_TURNS: usize = 360;

/// Which targets a robot reaches without contact, from any place of its base.
///
/// Every joint state within the limits that brings the tool to the target is tested against all solids: every branch with six axes
/// and a spherical wrist, otherwise those that 16 searches find. Links that no joint moves are tested too; what they touch in the
/// file, such as the floor, they may touch everywhere, no deeper than there. Contacts of other things with each other do not count.
///
/// Parameters
/// ----------
/// source
///     A `Cell`, where the tool is the one of its file and everything else stands as at the start; or a `Robot` alone, with the
///     frame of its `tip` as the tool.
/// robot
///     The robot of the cell; optional if there is only one.
/// turns
///     Number of turns about the axis that are tried for a target without one.
/// threads
///     The most threads that work; `None`: one per core.
///
/// Raises
/// ------
/// ArgumentError
///     If there is no such robot.
///
/// Examples
/// --------
/// >>> import numpy as np, elbowroom as er
/// >>> query = er.ReachQuery(er.Robot.load("examples/models/rx60b/rx60b.urdf"))
/// >>> down = np.array([[0.4, 0.0, 0.3, 0, 0, -1], [2.0, 0.0, 0.3, 0, 0, -1]], dtype=float)
/// >>> query.evaluate(down).free.tolist()
/// [2, 0]
#[pyclass(module = "elbowroom", frozen)]
pub struct ReachQuery {
    query: query::ReachQuery,
    joints: Vec<String>,
    source: Py<PyAny>,
    robot: Option<String>,
    turns: usize,
    threads: Option<NonZeroUsize>,
}

#[pymethods]
impl ReachQuery {
    #[new]
    #[pyo3(signature = (source, robot=None, *, turns=1, threads=None))]
    fn new(
        source: Bound<'_, PyAny>,
        robot: Option<String>,
        turns: usize,
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Self> {
        let py = source.py();
        let count = NonZeroUsize::new(turns).filter(|turns| turns.get() <= MOST_TURNS).ok_or_else(|| {
            Fault::Argument(format!("`turns` is {turns}\n  write: a whole number from 1 to {MOST_TURNS}, as 8"))
        })?;
        let (query, joints) = if let Ok(alone) = source.cast::<Robot>() {
            if let Some(name) = &robot {
                let text = format!("a Robot is alone, and not \"{name}\"\n  write: ReachQuery(robot)");
                return Err(Fault::Argument(text).into());
            }
            let alone = alone.get();
            let chain = &alone.model.chain;
            let model = QueryModel::of_robot(alone.path(), (*alone.model).clone());
            let query = py.detach(|| query::ReachQuery::new(&model, RobotId(0), chain.tip(), Pose::IDENTITY));
            (query, joint_names(chain))
        } else if let Ok(cell) = source.cast::<Cell>() {
            let cell = &cell.get().model;
            let (id, placed) = plan::select_robot(cell, robot.as_deref()).map_err(Fault::from)?;
            (py.detach(|| query::ReachQuery::of_cell(cell, id)), placed.joint_names())
        } else {
            let class = source.get_type().name().map(|n| n.to_string()).unwrap_or_default();
            let text = format!("a {class} reaches nothing\n  write: ReachQuery(Cell.load(…), \"arm\")");
            return Err(Fault::Argument(text).into());
        };
        let query = query.map_err(Fault::from)?.turns(count);
        Ok(Self { query, joints, source: source.unbind(), robot, turns, threads })
    }

    /// The names of the joints, in the order of the values.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.joints.clone()
    }

    /// The pose of the base in the file, `(4, 4)`: the root link in the world, metres.
    #[getter]
    fn base<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix(py, &self.query.base_in_world())
    }

    /// Find out how the targets are reached from a place of the base.
    ///
    /// Parameters
    /// ----------
    /// targets
    ///     `(N, 7)` frames of the tool in the world: x, y, z in metres, and the quaternion x, y, z, w. Or `(N, 6)`: a point, and the
    ///     direction of the tool's z axis; every turn about it will do.
    /// base
    ///     The pose of the root link in the world: a 4x4 array, `(xyz, quaternion xyzw)`, or `(xyz, rotation)`; default: `base`.
    /// progress
    ///     Whether to say on standard error how much is done.
    ///
    /// Returns
    /// -------
    /// Reach
    #[pyo3(signature = (targets, base=None, *, progress=false))]
    fn evaluate<'py>(
        &self,
        targets: &Bound<'py, PyAny>,
        base: Option<&Bound<'py, PyAny>>,
        progress: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = targets.py();
        let base = base.map_or_else(|| Ok(self.query.base_in_world()), pose_of)?;
        let targets = read(targets)?;
        let progress = Progress::new(py, progress, targets.len(), "targets")?;
        let (mut solutions, mut free, mut q) = (Vec::new(), Vec::new(), Vec::new());
        for chunk in targets.chunks(CHUNK) {
            let found = py.detach(|| self.query.evaluate(&base, chunk, self.threads)).map_err(Fault::from)?;
            for reach in found {
                // At most 16 states for each of at most 360 turns.
                solutions.push(u16::try_from(reach.solutions).unwrap_or(u16::MAX));
                free.push(u16::try_from(reach.free).unwrap_or(u16::MAX));
                q.extend(reach.q.unwrap_or_else(|| vec![f64::NAN; self.joints.len()]));
            }
            progress.add(py, chunk.len())?;
            py.check_signals()?;
        }
        progress.end(py)?;
        let q = shaped(&PyArray1::from_vec(py, q), [targets.len(), self.joints.len()])?;
        let (solutions, free) = (PyArray1::from_vec(py, solutions), PyArray1::from_vec(py, free));
        py.import("elbowroom.results")?.getattr("Reach")?.call1((solutions, free, q))
    }

    fn __repr__(&self) -> String {
        format!("ReachQuery({} joints, {} turns)", self.joints.len(), self.turns)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let args = (&self.source, &self.robot, self.turns, self.threads);
        py.import("elbowroom.pickles")?.getattr("reduced_reach")?.call1(args)
    }
}

/// The targets of an array with six or seven columns.
fn read(value: &Bound<'_, PyAny>) -> Result<Vec<ReachTarget>, Fault> {
    let is_axis = value.cast::<PyUntypedArray>().is_ok_and(|array| array.shape().get(1) == Some(&6));
    let width = if is_axis { 6 } else { 7 };
    let wanted = || "(N, 7), float64: x, y, z, quaternion x, y, z, w; or (N, 6): x, y, z, direction x, y, z".to_owned();
    let rows = Rows::of_width(value, "targets", width, &wanted)?;
    let mut targets = Vec::with_capacity(rows.len());
    while targets.len() < rows.len() {
        for row in rows.chunk(targets.len())?.chunks_exact(width) {
            targets.push(target(row).ok_or_else(|| {
                let what = if is_axis { "a direction" } else { "a quaternion" };
                Fault::Array(format!(
                    "`targets`: row {} has {what} of length 0\n  write: one of length 1",
                    targets.len()
                ))
            })?);
        }
    }
    Ok(targets)
}

fn target(row: &[f64]) -> Option<ReachTarget> {
    let point = Vec3::new(row[0], row[1], row[2]);
    match row[3..] {
        [x, y, z] => Some(ReachTarget::Axis { point, direction: Vec3::new(x, y, z).try_normalize()? }),
        [x, y, z, w] => Some(ReachTarget::Frame(Pose::new(Rotation::from_quaternion_xyzw([x, y, z, w])?, point))),
        _ => None,
    }
}
