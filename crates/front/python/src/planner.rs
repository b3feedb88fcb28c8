//! Paths without collision.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, TryLockError};
use std::time::Duration;

use elbowroom::cell::Cell as Model;
use elbowroom::kinematics::JointTrajectory;
use elbowroom::planner::{Interrupt, RrtConnectSettings};
use elbowroom::query::plan::{PathAnswer, PathGoal, PathPlanner, PathQuery, PathRequest, TcpMotion, select_robot};
use elbowroom::robot::{ObjectId, RobotId};
use elbowroom::spatial::Pose;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::vector;
use crate::cell::Cell;
use crate::checker::signals;
use crate::error::Fault;
use crate::page;
use crate::places::objects_at;
use crate::robot::pose_of;
use crate::rows::shaped;

/// Time between two checks whether a signal has arrived.
const BETWEEN_SIGNALS: Duration = Duration::from_millis(20);
/// Time between two tries to have the query, which another thread uses.
const BETWEEN_TRIES: Duration = Duration::from_millis(1);

/// Paths of a robot without collision.
///
/// Obstacles are the objects, the other robots at their start and the robot itself; guarded volumes stay out of permanent
/// forbidden regions. The scene, and the sphere covers or the map of the robot, are built when they are first needed, and kept.
/// Threads that share a planner take turns.
///
/// Parameters
/// ----------
/// cell
///     The cell.
/// robot
///     Name of the robot; `None` if there is only one.
/// planner
///     `"rrt-connect"`, or `"grid"`: through the free cells of the robot's map.
/// clearance_m
///     Distance to all obstacles, metres.
///
/// Raises
/// ------
/// ArgumentError
///     If the word for the planner is not known.
/// FileError
///     If the cell does not have this robot, or a solid of it is not finite.
///
/// Examples
/// --------
/// >>> import elbowroom as er
/// >>> planner = er.Planner(er.Cell.load("examples/exchange/cell.toml"), "left")
/// >>> path = planner.plan([1.0, 0.9, 0.2, 0, 0.8, 0], [-1.0, 0.9, 0.2, 0, 0.8, 0])
/// >>> path.found, path.q.shape[1]
/// (True, 6)
#[pyclass(module = "elbowroom", frozen)]
pub struct Planner {
    cell: Py<Cell>,
    model: Arc<Model>,
    id: RobotId,
    joints: Vec<String>,
    kind: PathPlanner,
    clearance_m: f64,
    query: Mutex<PathQuery<Arc<Model>>>,
}

impl Planner {
    /// Searches in another thread, so that this one notices signals meanwhile; one ends the search.
    fn search(&self, py: Python<'_>, request: &PathRequest) -> Result<PathAnswer, Fault> {
        let interrupt = Interrupt::default();
        let mut raised = None;
        let answer = py.detach(|| {
            std::thread::scope(|threads| {
                let (tell, told) = channel();
                threads.spawn(|| {
                    if let Some(mut query) = self.query(&interrupt) {
                        // The receiver is there until the answer is.
                        let _ = tell.send(query.plan_with(request, &interrupt));
                    }
                    drop(tell);
                });
                loop {
                    match told.recv_timeout(BETWEEN_SIGNALS) {
                        Ok(answer) => return Some(answer),
                        Err(RecvTimeoutError::Disconnected) => return None,
                        Err(RecvTimeoutError::Timeout) => {
                            if let Err(error) = Python::attach(signals) {
                                raised = Some(error);
                                interrupt.set();
                            }
                        }
                    }
                }
            })
        });
        match (raised, answer) {
            (Some(error), _) => Err(error.into()),
            (None, Some(answer)) => Ok(answer?),
            // The scope has raised the panic of the thread.
            (None, None) => Err(Fault::Argument("the search ended without an answer".into())),
        }
    }

    /// The query, for one thread at a time; `None` if the call was interrupted while another thread searched.
    fn query(&self, interrupt: &Interrupt) -> Option<MutexGuard<'_, PathQuery<Arc<Model>>>> {
        while !interrupt.is_set() {
            match self.query.try_lock() {
                Ok(query) => return Some(query),
                // Its answers do not depend on what a search has left.
                Err(TryLockError::Poisoned(poisoned)) => return Some(poisoned.into_inner()),
                Err(TryLockError::WouldBlock) => std::thread::sleep(BETWEEN_TRIES),
            }
        }
        None
    }

    /// The goal of a request: joint values or a pose.
    fn goal(&self, q1: Option<&Bound<'_, PyAny>>, pose: Option<&Bound<'_, PyAny>>) -> Result<PathGoal, Fault> {
        match (q1, pose) {
            (Some(q1), None) => Ok(vector(q1, "q1", &self.joints)?.into()),
            (None, Some(pose)) => Ok(PathGoal::Tcp(pose_of(pose)?.into())),
            _ => {
                let text = "a path has one goal\n  write: plan(q0, q1), or plan(q0, pose=…) for a pose of the tool";
                Err(Fault::Argument(text.into()))
            }
        }
    }
}

#[pymethods]
impl Planner {
    #[new]
    #[pyo3(signature = (cell, robot=None, *, planner="rrt-connect", clearance_m=0.0))]
    fn new(cell: Bound<'_, Cell>, robot: Option<&str>, planner: &str, clearance_m: f64) -> PyResult<Self> {
        let model = cell.get().model.clone();
        let (id, named) = select_robot(&model, robot).map_err(Fault::from)?;
        let joints = named.joint_names();
        let kind = match planner {
            "rrt-connect" => PathPlanner::RrtConnect,
            "grid" => PathPlanner::Grid,
            other => {
                let text = format!("`planner` is \"{other}\"\n  write: \"rrt-connect\" or \"grid\"");
                return Err(Fault::Argument(text).into());
            }
        };
        // Written so that NaN fails.
        if !(clearance_m >= 0.0 && clearance_m.is_finite()) {
            let text =
                format!("`clearance_m` is {clearance_m}\n  write: a finite number of metres, 0 or more, as 0.02");
            return Err(Fault::Argument(text).into());
        }
        let query = cell.py().detach(|| PathQuery::new(model.clone()).map_err(Fault::from))?;
        Ok(Self { cell: cell.unbind(), model, id, joints, kind, clearance_m, query: Mutex::new(query) })
    }

    /// The name of the robot.
    #[getter]
    fn robot(&self) -> &str {
        &self.model.robots[self.id.0].name
    }

    /// The names of the joints, in the order of the values.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.joints.clone()
    }

    /// Find a path between two states, and time it.
    ///
    /// Ctrl-C ends the search; covers and maps that the first call builds are built to their end before.
    ///
    /// Parameters
    /// ----------
    /// q0
    ///     The start: `(dof,)`, rad or m.
    /// q1
    ///     The goal, likewise.
    /// pose
    ///     Instead of `q1`, a pose of the tool centre point in the world: a 4x4 array, `(xyz, quaternion xyzw)`, or
    ///     `(xyz, rotation)`.
    /// linear
    ///     Whether the tool centre point moves straight to the pose.
    /// objects
    ///     Objects at other places than in the file: the pose of each in the world, by its name.
    /// speed
    ///     The part of the joints' speeds that the motion uses, above 0 and at most 1.
    /// time_limit_s
    ///     Time limit of the search.
    /// seed
    ///     The same seed gives the same path.
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
    ///     If start or goal collide, are in a region or beyond limits.
    #[pyo3(signature = (q0, q1=None, *, pose=None, linear=false, objects=None, speed=1.0, time_limit_s=5.0, seed=1, optimize=false, period_s=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn plan<'py>(
        &self,
        q0: &Bound<'py, PyAny>,
        q1: Option<&Bound<'py, PyAny>>,
        pose: Option<&Bound<'py, PyAny>>,
        linear: bool,
        objects: Option<&Bound<'py, PyAny>>,
        speed: f64,
        time_limit_s: f64,
        seed: u64,
        optimize: bool,
        period_s: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = q0.py();
        let limit = Duration::try_from_secs_f64(time_limit_s).ok().filter(|limit| !limit.is_zero());
        let time_limit = limit.ok_or_else(|| {
            Fault::Argument(format!("`time_limit_s` is {time_limit_s}\n  write: seconds above 0, as 5.0"))
        })?;
        if let Some(period_s) = period_s.filter(|period_s| !(*period_s > 0.0 && period_s.is_finite())) {
            return Err(Fault::Argument(format!("`period_s` is {period_s}\n  write: seconds above 0, as 0.01")).into());
        }
        // Written so that NaN fails.
        if !(speed > 0.0 && speed <= 1.0) {
            return Err(Fault::Argument(format!("`speed` is {speed}\n  write: a number above 0 and at most 1")).into());
        }
        let clearance_m = self.clearance_m;
        let request = PathRequest {
            robot: Some(self.robot().to_owned()),
            from: Some(vector(q0, "q0", &self.joints)?),
            to: self.goal(q1, pose)?,
            planner: self.kind,
            tcp_motion: if linear { TcpMotion::Linear } else { TcpMotion::Free },
            speed,
            options: RrtConnectSettings { time_limit, clearance_m, seed, ..RrtConnectSettings::default() },
            period_s,
            optimize,
            placed: objects.map_or(Ok(Vec::new()), |objects| objects_at(&self.model, objects))?,
            ..PathRequest::default()
        };
        let answer = self.search(py, &request)?;
        let motion = answer.timed.as_ref().map(|timed| (self.id, timed.trajectory.clone()));
        path(py, &answer, PathRecord { model: self.model.clone(), placed: request.placed, motion })
    }

    fn __repr__(&self) -> String {
        format!("Planner({:?} of {:?})", self.robot(), self.model.name)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let kind = match self.kind {
            PathPlanner::RrtConnect => "rrt-connect",
            PathPlanner::Grid => "grid",
        };
        let args = (&self.cell, self.robot(), kind, self.clearance_m);
        py.import("elbowroom.pickles")?.getattr("reduced_planner")?.call1(args)
    }
}

/// A path in its cell; `elbowroom.results.Path` has it.
#[pyclass(module = "elbowroom", frozen)]
pub struct PathRecord {
    model: Arc<Model>,
    /// The objects at other places than in the file.
    placed: Vec<(ObjectId, Pose)>,
    motion: Option<(RobotId, JointTrajectory)>,
}

#[pymethods]
impl PathRecord {
    /// The robot on its path as an HTML page that needs no network; the cell at its start if there is no path.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        let page = || {
            page::of_motions(
                &self.model.with_objects_at(&self.placed),
                "plan",
                self.motion.clone().into_iter().collect(),
            )
        };
        Ok(py.detach(page)?)
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
