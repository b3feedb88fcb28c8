//! Arms that act as one, step by step.

use std::sync::{Arc, Mutex, MutexGuard};

use elbowroom::cell::{Cell as Model, CellVirtualRobot};
use elbowroom::cooperation::VirtualRobot as Arms;
use elbowroom::spatial::Pose;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use self_cell::self_cell;

use crate::arrays::vector;
use crate::cell::{Cell, joints_of};
use crate::error::Fault;
use crate::matrix::{matrix, values};
use crate::robot::pose_of;
use crate::rows::shaped;
use crate::session::{Surroundings, broken, in_parts, named, poses_of_rows, share};

/// Distance between two robots beyond which it is not measured, m.
const FAR_M: f64 = 0.1;

/// Most steps of a call.
const MOST_STEPS: usize = 1_000_000;

/// The arms with the time of the session.
struct Moving<'s> {
    arms: Arms<'s>,
    steps: u64,
}

self_cell!(
    /// Arms beside the scene that they borrow.
    struct Session {
        owner: Surroundings,

        #[not_covariant]
        dependent: Moving,
    }
);

fn spec(surroundings: &Surroundings) -> &CellVirtualRobot {
    &surroundings.cell.guidance.virtual_robots[surroundings.index]
}

/// Several arms that carry a work-piece as one: they hold it, hand it over, and wait where they are not in the way.
///
/// Members, grasps and settings come from `[virtual_robot.NAME]` in the cell file; the stream of that table is not read, the
/// desired poses come from the calls. Other robots and objects stay where they are at the start. The work-piece is always on its
/// desired path: what stands in the way makes it slower. Threads that share a virtual robot take turns.
///
/// Parameters
/// ----------
/// cell
///     The cell.
/// name
///     Name of the virtual robot; `None` if there is only one.
///
/// Raises
/// ------
/// ArgumentError
///     If the cell does not have it.
/// FileError
///     If its holder does not hold the work-piece at the start, or something touches.
///
/// Examples
/// --------
/// >>> import elbowroom as er
/// >>> trio = er.VirtualRobot(er.Cell.load("examples/inspection/cell.toml"))
/// >>> trio.robots
/// ['one', 'two', 'three']
/// >>> step = trio.step(trio.part)            # the work-piece stays
/// >>> step.holder, step.hold
/// ('one', None)
#[pyclass(module = "elbowroom", frozen)]
pub struct VirtualRobot {
    cell: Arc<Model>,
    index: usize,
    session: Mutex<Session>,
}

impl VirtualRobot {
    fn begin(cell: &Arc<Model>, index: usize) -> Result<Session, Fault> {
        let owner = Surroundings::of(cell, index)?;
        Session::try_new(owner, |owner| Ok(Moving { arms: spec(owner).start(&owner.cell, &owner.scene)?, steps: 0 }))
    }

    fn spec(&self) -> &CellVirtualRobot {
        &self.cell.guidance.virtual_robots[self.index]
    }

    /// The session, for one thread at a time. Call it only where other threads of Python may run, which may hold it.
    fn session(&self) -> Result<MutexGuard<'_, Session>, Fault> {
        self.session.lock().map_err(|_| broken())
    }

    /// Reads from the arms.
    fn read<T: Send>(&self, py: Python<'_>, of: impl FnOnce(&Arms<'_>) -> T + Send) -> Result<T, Fault> {
        py.detach(|| Ok(self.session()?.with_dependent(|_, moving| of(&moving.arms))))
    }

    fn member(&self, index: usize) -> &str {
        &self.cell.robots[self.spec().members[index].robot.0].name
    }

    /// Makes a step of a tick. A pose that is refused is an error, and nothing moves.
    fn advance(
        &self,
        session: &mut Session,
        input: Input<'_>,
        overrides: &[f64],
        out: &mut Steps,
    ) -> Result<(), Fault> {
        let timing = self.cell.timing;
        session.with_dependent_mut(|surroundings, moving| {
            match input {
                Input::Desired(pose) => moving.arms.desire(timing.at(moving.steps), pose).map_err(|e| {
                    Fault::Argument(format!("the desired pose: {e}\n  write: a pose nearer to the one before"))
                })?,
                Input::Nothing => {}
                Input::Disabled => moving.arms.pause(),
            }
            moving.steps += 1;
            let step = moving.arms.step(timing.tick_s, overrides);
            out.add(surroundings, &mut moving.arms, &step);
            Ok(())
        })
    }

    /// Makes a step for each input.
    fn steps<'py>(
        &self,
        py: Python<'py>,
        inputs: &[Input<'_>],
        overrides: &[f64],
        progress: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut steps = Steps::default();
        in_parts(py, inputs, progress, |part| {
            let mut session = self.session()?;
            part.iter().try_for_each(|input| self.advance(&mut session, *input, overrides, &mut steps))
        })?;
        steps.told(py, self.joints())
    }

    /// Overrides of all members.
    fn overrides(&self, given: Option<&Bound<'_, PyAny>>) -> Result<Vec<f64>, Fault> {
        let names = self.robots();
        let Some(given) = given else { return Ok(vec![1.0; names.len()]) };
        if let Ok(all) = given.extract::<f64>() {
            return Ok(vec![share(all)?; names.len()]);
        }
        vector(given, "speed_override", &names)?.into_iter().map(share).collect()
    }
}

/// What an operator gives in a step.
#[derive(Clone, Copy)]
enum Input<'a> {
    /// A new desired pose.
    Desired(&'a Pose),
    /// No new pose: the work-piece goes on to the last one.
    Nothing,
    /// The enabling switch is not pressed.
    Disabled,
}

/// What the steps did, one after another.
#[derive(Default)]
struct Steps {
    q: Vec<f64>,
    part: Vec<f64>,
    holders: Vec<String>,
    rate: Vec<f64>,
    holds: Vec<Option<String>>,
    handed_over: Vec<Option<String>>,
    gap_m: Vec<f64>,
}

impl Steps {
    fn add(
        &mut self,
        surroundings: &Surroundings,
        arms: &mut Arms<'_>,
        step: &elbowroom::cooperation::CooperationStep,
    ) {
        let (cell, spec) = (&surroundings.cell, spec(surroundings));
        for member in 0..spec.members.len() {
            self.q.extend(arms.q(member));
        }
        self.part.extend(values(&arms.part_in_world()));
        self.holders.push(cell.robots[spec.members[arms.holder()].robot.0].name.clone());
        self.rate.push(step.rate);
        self.holds.push(step.hold.map(|hold| spec.hold_in_words(cell, &hold)));
        self.handed_over.push(step.handed_over.map(|handed_over| spec.hand_over_in_words(cell, &handed_over)));
        self.gap_m.push(arms.gap_m(FAR_M));
    }

    /// The steps as an object of the package.
    fn told(self, py: Python<'_>, joints: Vec<String>) -> PyResult<Bound<'_, PyAny>> {
        let (count, dof) = (self.rate.len(), joints.len());
        let q = shaped(&PyArray1::from_vec(py, self.q), [count, dof])?;
        let part = shaped(&PyArray1::from_vec(py, self.part), [count, 4, 4])?;
        let (rate, gap) = (PyArray1::from_vec(py, self.rate), PyArray1::from_vec(py, self.gap_m));
        let make = py.import("elbowroom.results")?.getattr("Cooperation")?;
        make.call1((joints, q, part, self.holders, rate, self.holds, self.handed_over, gap))
    }
}

#[pymethods]
impl VirtualRobot {
    #[new]
    #[pyo3(signature = (cell, name=None))]
    fn new(py: Python<'_>, cell: &Bound<'_, Cell>, name: Option<&str>) -> PyResult<Self> {
        let cell = cell.get().model.clone();
        let names: Vec<&str> = cell.guidance.virtual_robots.iter().map(|spec| spec.name.as_str()).collect();
        let index = named("virtual_robot", &names, name)?;
        let session = py.detach(|| Self::begin(&cell, index))?;
        Ok(Self { cell, index, session: Mutex::new(session) })
    }

    /// The names of the robots that act as one.
    #[getter]
    fn robots(&self) -> Vec<String> {
        (0..self.spec().members.len()).map(|member| self.member(member).to_owned()).collect()
    }

    /// The names of their joints, `robot.joint`, in the order of the values.
    #[getter]
    fn joints(&self) -> Vec<String> {
        joints_of(self.spec().members.iter().map(|member| &self.cell.robots[member.robot.0]))
    }

    /// Duration of a step: the tick of the cell, seconds.
    #[getter]
    fn period_s(&self) -> f64 {
        self.cell.timing.tick_s
    }

    /// The joint values of all members, `(joints,)`, rad or m.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let members = self.spec().members.len();
        let q = self.read(py, |arms| (0..members).flat_map(|member| arms.q(member).to_vec()).collect())?;
        Ok(PyArray1::from_vec(py, q))
    }

    /// The pose of the work-piece in the world, `(4, 4)`.
    #[getter]
    #[expect(clippy::redundant_closure_for_method_calls, reason = "the method is not of every lifetime")]
    fn part<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let pose = self.read(py, |arms| arms.part_in_world())?;
        matrix(py, &pose)
    }

    /// The name of the robot that holds the work-piece.
    #[getter]
    #[expect(clippy::redundant_closure_for_method_calls, reason = "the method is not of every lifetime")]
    fn holder(&self, py: Python<'_>) -> PyResult<&str> {
        Ok(self.member(self.read(py, |arms| arms.holder())?))
    }

    /// The part of the desired path that is still before the work-piece, seconds at full speed; speeding up and braking add to it.
    #[getter]
    fn left_s(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.read(py, |arms| arms.on_path().1)?)
    }

    /// Make a step of `period_s`.
    ///
    /// Parameters
    /// ----------
    /// pose
    ///     The desired pose of the work-piece in the world: a 4x4 array, `(xyz, quaternion xyzw)`, or `(xyz, rotation)`. The
    ///     work-piece goes there straight from the one before, at the speed at which they come or more slowly. `None`: the enabling
    ///     switch is not pressed, and it stands until the next pose; arms that wait still keep out of the way.
    /// speed_override
    ///     The overrides of the monitors, 0 to 1: one per robot of `robots`, or one for all; default: 1.
    ///
    /// Returns
    /// -------
    /// CooperationStep
    #[pyo3(signature = (pose, *, speed_override=None))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        pose: Option<&Bound<'py, PyAny>>,
        speed_override: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (wanted, allowed) = (pose.map(pose_of).transpose()?, self.overrides(speed_override)?);
        let mut steps = Steps::default();
        let input = wanted.as_ref().map_or(Input::Disabled, Input::Desired);
        py.detach(|| self.advance(&mut *self.session()?, input, &allowed, &mut steps))?;
        steps.told(py, self.joints())?.getattr("_only")?.call0()
    }

    /// Make a step for each desired pose.
    ///
    /// The work-piece may be behind at the end: `left_s` says how much, and `go_on` brings it there. An interrupted call leaves the
    /// arms where it was interrupted.
    ///
    /// Parameters
    /// ----------
    /// poses
    ///     `(N, 7)`: x, y, z in metres, and the quaternion x, y, z, w, of the work-piece in the world.
    /// speed_override
    ///     As for `step`.
    /// progress
    ///     Whether to say on standard error how much is done.
    ///
    /// Returns
    /// -------
    /// Cooperation
    #[pyo3(signature = (poses, *, speed_override=None, progress=false))]
    fn follow<'py>(
        &self,
        poses: &Bound<'py, PyAny>,
        speed_override: Option<&Bound<'py, PyAny>>,
        progress: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, allowed) = (poses.py(), self.overrides(speed_override)?);
        let poses = poses_of_rows(poses)?;
        let inputs: Vec<Input<'_>> = poses.iter().map(Input::Desired).collect();
        self.steps(py, &inputs, &allowed, progress)
    }

    /// Make steps without a new pose: the work-piece goes on to the last one that was desired; after `step(None)` it stands.
    ///
    /// Parameters
    /// ----------
    /// steps
    ///     How many.
    /// speed_override
    ///     As for `step`.
    /// progress
    ///     Whether to say on standard error how much is done.
    ///
    /// Returns
    /// -------
    /// Cooperation
    #[pyo3(signature = (steps=1, *, speed_override=None, progress=false))]
    fn go_on<'py>(
        &self,
        py: Python<'py>,
        steps: i64,
        speed_override: Option<&Bound<'py, PyAny>>,
        progress: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let count = usize::try_from(steps).ok().filter(|count| (1..=MOST_STEPS).contains(count));
        let count = count
            .ok_or_else(|| Fault::Argument(format!("`steps` is {steps}\n  write: a number from 1 to {MOST_STEPS}")))?;
        self.steps(py, &vec![Input::Nothing; count], &self.overrides(speed_override)?, progress)
    }

    /// Begin anew: the robots are at their start.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| {
            let session = Self::begin(&self.cell, self.index)?;
            self.session.clear_poison();
            *self.session()? = session;
            Ok::<(), Fault>(())
        })?;
        Ok(())
    }

    fn __repr__(&self) -> String {
        format!("VirtualRobot({:?}: {})", self.spec().name, self.robots().join(", "))
    }

    #[expect(clippy::unused_self, reason = "a method of Python")]
    fn __reduce__(&self) -> PyResult<()> {
        let text = "a virtual robot has a state, so it is not copied\n  write: VirtualRobot(cell) in each process";
        Err(Fault::Argument(text.into()).into())
    }
}
