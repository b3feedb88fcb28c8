//! Paths without collision.

use std::sync::Arc;
use std::time::Duration;

use elbowroom::cell::Cell as Model;
use elbowroom::kinematics::JointTrajectory;
use elbowroom::planner::RrtConnectSettings;
use elbowroom::query::plan::{self as paths, PathAnswer, PathPlanner, PathRequest};
use elbowroom::robot::RobotId;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::vector;
use crate::cell::Cell;
use crate::error::Fault;
use crate::page;
use crate::rows::shaped;

/// Find a path without collision between two states, and time it.
///
/// Obstacles are the objects, the other robots at their start and the robot itself; guarded volumes stay out of permanent
/// forbidden regions.
///
/// Parameters
/// ----------
/// cell
///     The cell.
/// robot
///     Name of the robot; `None` if there is only one.
/// q0, q1
///     Start and goal: `dof` values, rad or m.
/// time_limit_s
///     Time limit of the search.
/// clearance_m
///     Distance to all obstacles.
/// seed
///     The same seed gives the same path.
/// planner
///     `"rrt-connect"`, or `"grid"`: through the free cells of the robot's map.
/// optimize
///     Whether to search for shorter paths until the time limit.
/// period_s
///     Time between rows; default: the tick of the cell.
///
/// Returns
/// -------
/// Path
///     False as a condition if no path was found; then `reason` says why.
///
/// Raises
/// ------
/// FileError
///     If start or goal collide, are in a region or beyond limits, or if there is no such robot.
///
/// Examples
/// --------
/// >>> import elbowroom as er
/// >>> cell = er.Cell.load("examples/exchange/cell.toml")
/// >>> path = er.plan(cell, "left", [1.0, 0.9, 0.2, 0, 0.8, 0], [-1.0, 0.9, 0.2, 0, 0.8, 0])
/// >>> path.found, path.q.shape[1]
/// (True, 6)
#[pyfunction]
#[pyo3(signature = (cell, robot, q0, q1, *, time_limit_s=5.0, clearance_m=0.0, seed=1, planner="rrt-connect", optimize=false, period_s=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn plan<'py>(
    cell: &Bound<'py, Cell>,
    robot: Option<String>,
    q0: &Bound<'py, PyAny>,
    q1: &Bound<'py, PyAny>,
    time_limit_s: f64,
    clearance_m: f64,
    seed: u64,
    planner: &str,
    optimize: bool,
    period_s: Option<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let (py, cell) = (cell.py(), &cell.get().model);
    let (id, named) = paths::select_robot(cell, robot.as_deref()).map_err(Fault::from)?;
    let joints = named.joint_names();
    let (from, to) = (vector(q0, "q0", &joints)?, vector(q1, "q1", &joints)?);
    let limit = Duration::try_from_secs_f64(time_limit_s).ok().filter(|limit| !limit.is_zero());
    let limit = limit.ok_or_else(|| {
        Fault::Argument(format!("`time_limit_s` is {time_limit_s}\n  write: seconds above 0, as 5.0"))
    })?;
    let planner = match planner {
        "rrt-connect" => PathPlanner::RrtConnect,
        "grid" => PathPlanner::Grid,
        other => {
            let text = format!("there is no planner \"{other}\"\n  write: \"rrt-connect\" or \"grid\"");
            return Err(Fault::Argument(text).into());
        }
    };
    let options = RrtConnectSettings { time_limit: limit, clearance_m, seed, ..RrtConnectSettings::default() };
    let request = PathRequest {
        robot,
        from: Some(from),
        to: to.into(),
        planner,
        options,
        optimize,
        period_s,
        ..PathRequest::default()
    };
    let answer = py.detach(|| paths::plan(cell, &request).map_err(Fault::from))?;
    let motion = answer.timed.as_ref().map(|timed| (id, timed.trajectory.clone()));
    path(py, &answer, PathRecord { model: cell.clone(), motion })
}

/// A path in its cell; `elbowroom.results.Path` has it.
#[pyclass(module = "elbowroom", frozen)]
pub struct PathRecord {
    model: Arc<Model>,
    motion: Option<(RobotId, JointTrajectory)>,
}

#[pymethods]
impl PathRecord {
    /// The robot on its path as an HTML page that needs no network; the cell at its start if there is no path.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        Ok(py.detach(|| page::of_motion(&self.model, "plan", self.motion.clone()))?)
    }
}

/// A path as an object of the package.
fn path<'py>(py: Python<'py>, answer: &PathAnswer, record: PathRecord) -> PyResult<Bound<'py, PyAny>> {
    let dof = answer.joints.len();
    let array = |rows: Vec<&[f64]>| {
        let (count, values) = (rows.len(), rows.concat());
        shaped(&PyArray1::from_vec(py, values), [count, dof])
    };
    let timed = answer.timed.as_ref();
    let waypoints = timed.map(|timed| timed.path.waypoints.iter().map(Vec::as_slice).collect()).unwrap_or_default();
    let rows = timed.map(|timed| timed.trajectory.rows()).unwrap_or_default();
    let times = PyArray1::from_vec(py, rows.iter().map(|row| row.t_s).collect());
    let q = array(rows.iter().map(|row| row.q.as_slice()).collect())?;
    let length = timed.map(|timed| timed.path.length_rad);
    py.import("elbowroom.results")?.getattr("Path")?.call1((
        answer.found,
        answer.reason.as_deref(),
        &answer.robot,
        &answer.joints,
        array(waypoints)?,
        times,
        q,
        length,
        answer.planning_us + answer.simplify_us,
        record,
    ))
}
