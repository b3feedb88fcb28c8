//! An arm that a person guides, step by step.

use std::sync::{Arc, Mutex, MutexGuard};

use elbowroom::cell::{Cell as Model, CellOperator, OperatedArm};
use elbowroom::shared_control::{ArmLimit, GuidedStep, Limit};
use elbowroom::spatial::Pose;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use self_cell::self_cell;

use crate::cell::Cell;
use crate::error::Fault;
use crate::matrix::{matrix, values};
use crate::robot::pose_of;
use crate::rows::shaped;
use crate::session::{Surroundings, broken, in_parts, named, poses_of_rows, share};

self_cell!(
    /// An arm beside the scene that it borrows.
    struct Session {
        owner: Surroundings,

        #[not_covariant]
        dependent: OperatedArm,
    }
);

fn operator(surroundings: &Surroundings) -> &CellOperator {
    &surroundings.cell.guidance.operators[surroundings.index]
}

/// A robot that a person guides: its tool follows poses and glides along surfaces, shields and guides.
///
/// The arm has the fixtures, forces and settings of `[operator.NAME]` in the cell file; the stream of that table is not read, the poses
/// come from the calls. Fixtures are on as at the start of the stream. Other robots and objects stay where they are at the start.
/// No motion is made that is not proven free. Threads that share an arm take turns.
///
/// Parameters
/// ----------
/// cell
///     The cell.
/// operator
///     Name of the operator; `None` if there is only one.
///
/// Raises
/// ------
/// ArgumentError
///     If the cell does not have this operator.
/// FileError
///     If the arm starts too near to a surface, or a shield cannot be made.
///
/// Examples
/// --------
/// >>> import numpy as np, elbowroom as er
/// >>> arm = er.GuidedArm(er.Cell.load("examples/guided/cell.toml"))
/// >>> start = arm.tool
/// >>> step = arm.step(start)                 # the hand keeps still
/// >>> bool(np.abs(step.tool - start).max() < 1e-9), step.limit
/// (True, None)
#[pyclass(module = "elbowroom", frozen)]
pub struct GuidedArm {
    cell: Arc<Model>,
    operator: usize,
    notes: Vec<String>,
    session: Mutex<Session>,
}

impl GuidedArm {
    fn begin(cell: &Arc<Model>, operator: usize) -> Result<(Session, Vec<String>), Fault> {
        let mut notes = Vec::new();
        let owner = Surroundings::of(cell, operator)?;
        let session =
            Session::try_new(owner, |owner| self::operator(owner).arm(&owner.cell, &owner.scene, &mut notes))?;
        Ok((session, notes.iter().map(ToString::to_string).collect()))
    }

    /// The session, for one thread at a time. Call it only where other threads of Python may run, which may hold it.
    fn session(&self) -> Result<MutexGuard<'_, Session>, Fault> {
        self.session.lock().map_err(|_| broken())
    }

    fn operator(&self) -> &CellOperator {
        &self.cell.guidance.operators[self.operator]
    }

    /// Makes a step of a tick.
    fn advance(&self, session: &mut Session, wanted: Option<&Pose>, speed_override: f64, out: &mut Steps) {
        let tick_s = self.cell.timing.tick_s;
        session.with_dependent_mut(|surroundings, operated| {
            let step = operated.arm.step(wanted, tick_s, speed_override);
            out.add(surroundings, operated, &step);
        });
    }
}

/// What the steps did, one after another.
#[derive(Default)]
struct Steps {
    q: Vec<f64>,
    tool: Vec<f64>,
    gap_m: Vec<f64>,
    limits: Vec<Option<&'static str>>,
    limited_by: Vec<Option<String>>,
    force_n: Vec<f64>,
}

impl Steps {
    fn add(&mut self, surroundings: &Surroundings, operated: &OperatedArm<'_>, step: &GuidedStep) {
        self.q.extend(operated.arm.q());
        self.tool.extend(values(&operated.arm.tool_in_world()));
        self.gap_m.push(step.tool.gap_m.unwrap_or(f64::NAN));
        self.limits.push(step.limit.map(word));
        let Surroundings { cell, .. } = surroundings;
        self.limited_by.push(step.limit.and_then(|limit| operator(surroundings).limited_by(cell, limit)));
        let force = operated.arm.forces().map_or([f64::NAN; 3], |forces| forces.force_on_hand().to_array());
        self.force_n.extend(force);
    }

    /// The steps as an object of the package.
    fn told(self, py: Python<'_>, joints: Vec<String>) -> PyResult<Bound<'_, PyAny>> {
        let (count, dof) = (self.gap_m.len(), joints.len());
        let q = shaped(&PyArray1::from_vec(py, self.q), [count, dof])?;
        let tool = shaped(&PyArray1::from_vec(py, self.tool), [count, 4, 4])?;
        let force = shaped(&PyArray1::from_vec(py, self.force_n), [count, 3])?;
        let gap = PyArray1::from_vec(py, self.gap_m);
        let make = py.import("elbowroom.results")?.getattr("Guidance")?;
        make.call1((joints, q, tool, gap, self.limits, self.limited_by, force))
    }
}

/// The word for what kept an arm from following.
fn word(limit: ArmLimit) -> &'static str {
    match limit {
        ArmLimit::Tool(Limit::Surface) => "surface",
        ArmLimit::Tool(Limit::Entry) => "entry",
        ArmLimit::Tool(Limit::Proof) | ArmLimit::Unproven => "unproven",
        ArmLimit::Tool(Limit::PoseNotFinite) => "pose",
        ArmLimit::Tool(Limit::StepDuration) => "tick too long",
        ArmLimit::Tool(Limit::DistanceUnknown) => "distance unknown",
        ArmLimit::Reach => "reach",
        ArmLimit::JointSpeed(_) => "joint speed",
        ArmLimit::Contact(..) => "contact",
        ArmLimit::Energy => "energy",
    }
}

#[pymethods]
impl GuidedArm {
    #[new]
    #[pyo3(signature = (cell, operator=None))]
    fn new(py: Python<'_>, cell: &Bound<'_, Cell>, operator: Option<&str>) -> PyResult<Self> {
        let cell = cell.get().model.clone();
        let names: Vec<&str> = cell.guidance.operators.iter().map(|operator| operator.name.as_str()).collect();
        let operator = named("operator", &names, operator)?;
        let (session, notes) = py.detach(|| Self::begin(&cell, operator))?;
        Ok(Self { cell, operator, notes, session: Mutex::new(session) })
    }

    /// The name of the robot.
    #[getter]
    fn robot(&self) -> &str {
        &self.cell.robots[self.operator().robot.0].name
    }

    /// The names of its joints, in the order of the values.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.cell.robots[self.operator().robot.0].joint_names()
    }

    /// Duration of a step: the tick of the cell, seconds.
    #[getter]
    fn period_s(&self) -> f64 {
        self.cell.timing.tick_s
    }

    /// What the tool does not glide along, and other remarks.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// The joint values, `(dof,)`, rad or m.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let q =
            py.detach(|| Ok::<_, Fault>(self.session()?.with_dependent(|_, operated| operated.arm.q().to_vec())))?;
        Ok(PyArray1::from_vec(py, q))
    }

    /// The pose of the tool centre point in the world, `(4, 4)`.
    #[getter]
    fn tool<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let pose =
            py.detach(|| Ok::<_, Fault>(self.session()?.with_dependent(|_, operated| operated.arm.tool_in_world())))?;
        matrix(py, &pose)
    }

    /// Make a step of `period_s` towards a pose of the hand.
    ///
    /// Parameters
    /// ----------
    /// pose
    ///     The pose of the tool centre point in the world that the hand wants: a 4x4 array, `(xyz, quaternion xyzw)`, or
    ///     `(xyz, rotation)`; `None`: the enabling switch is not pressed, and the arm comes to rest.
    /// speed_override
    ///     The override of the monitor, 0 to 1.
    ///
    /// Returns
    /// -------
    /// GuidedStep
    #[pyo3(signature = (pose, *, speed_override=1.0))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        pose: Option<&Bound<'py, PyAny>>,
        speed_override: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (wanted, allowed) = (pose.map(pose_of).transpose()?, share(speed_override)?);
        let mut steps = Steps::default();
        py.detach(|| {
            self.advance(&mut *self.session()?, wanted.as_ref(), allowed, &mut steps);
            Ok::<(), Fault>(())
        })?;
        steps.told(py, self.joints())?.getattr("_only")?.call0()
    }

    /// Make a step for each pose.
    ///
    /// An interrupted call leaves the arm where it was interrupted.
    ///
    /// Parameters
    /// ----------
    /// poses
    ///     `(N, 7)`: x, y, z in metres, and the quaternion x, y, z, w, of the tool centre point in the world.
    /// speed_override
    ///     The override of the monitor, 0 to 1.
    /// progress
    ///     Whether to say on standard error how much is done.
    ///
    /// Returns
    /// -------
    /// Guidance
    #[pyo3(signature = (poses, *, speed_override=1.0, progress=false))]
    fn follow<'py>(
        &self,
        poses: &Bound<'py, PyAny>,
        speed_override: f64,
        progress: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, allowed) = (poses.py(), share(speed_override)?);
        let poses = poses_of_rows(poses)?;
        let mut steps = Steps::default();
        in_parts(py, &poses, progress, |part| {
            let mut session = self.session()?;
            for wanted in part {
                self.advance(&mut session, Some(wanted), allowed, &mut steps);
            }
            Ok(())
        })?;
        steps.told(py, self.joints())
    }

    /// Begin anew: the arm is at its start.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| {
            let (session, _) = Self::begin(&self.cell, self.operator)?;
            self.session.clear_poison();
            *self.session()? = session;
            Ok::<(), Fault>(())
        })?;
        Ok(())
    }

    fn __repr__(&self) -> String {
        format!("GuidedArm({:?} by {:?})", self.robot(), self.operator().name)
    }

    #[expect(clippy::unused_self, reason = "a method of Python")]
    fn __reduce__(&self) -> PyResult<()> {
        let text = "a guided arm has a state, so it is not copied\n  write: GuidedArm(cell) in each process";
        Err(Fault::Argument(text.into()).into())
    }
}
