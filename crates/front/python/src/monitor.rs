//! The monitors of a cell: overrides of the speed, tick by tick.

use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use elbowroom::cell::{Cell as Model, CellInstant, CellMonitors, CellRegionId, CellRobot, RobotTick};
use elbowroom::monitor::{AccessClass, Monitor as RobotMonitor, OverrideReason};
use elbowroom::robot::RobotId;
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays::Rows;
use crate::cell::{Cell, joints_of};
use crate::error::Fault;
use crate::progress::Progress;
use crate::rows::shaped;

/// Rows between two looks at the signals: the slowest tick of the examples takes an eighth of a millisecond.
const BETWEEN_SIGNALS: usize = 256;

/// Region, and what happened.
type EventNames = Vec<(Option<String>, &'static str)>;

/// The monitors of all robots of a cell: how fast each robot may move.
///
/// A host ticks it once per period of its controller, with the state of every robot; robots that share regions grant them to
/// each other. Belts, moving objects and pose files of the cell are where they are at the time of the tick. A state that is
/// NaN or jumps, or a time that goes back, is no exception: the answer is override 0 and the reason. Objects that programs grip, and
/// tools that they exchange, stay as at the start.
///
/// Parameters
/// ----------
/// cell
///     The cell.
///
/// Raises
/// ------
/// FileError
///     With the line of what a monitor refuses.
///
/// Examples
/// --------
/// >>> import elbowroom as er
/// >>> monitor = er.Monitor(er.Cell.load("examples/figure12/cell.toml"))
/// >>> tick = monitor.tick(0.0, [0] * 6, qd=[0] * 6)["ns16"]
/// >>> tick.speed_override, tick.reason
/// (1.0, 'free')
/// >>> monitor.tick(0.002, [float("nan")] * 6)["ns16"].speed_override
/// 0.0
#[pyclass(module = "elbowroom", frozen)]
pub struct Monitor {
    cell: Arc<Model>,
    state: Mutex<State>,
    joints: Vec<String>,
}

/// What changes from tick to tick.
struct State {
    monitors: CellMonitors,
    /// The robots whose distances were measured in the last tick.
    measured: Vec<bool>,
}

impl State {
    fn new(cell: Arc<Model>) -> Result<Self, Fault> {
        Ok(Self { measured: vec![false; cell.robots.len()], monitors: CellMonitors::new(cell)? })
    }

    fn tick(&mut self, at: &CellInstant<'_>) -> Vec<RobotTick> {
        let ticks = self.monitors.tick(at);
        self.measured = ticks.iter().map(|tick| !is_fault(tick)).collect();
        ticks
    }

    /// Each robot that is guarded, with its tick and its monitor. Nothing guards a mechanism.
    fn guarded<'a>(
        &'a self,
        ticks: &'a [RobotTick],
    ) -> impl Iterator<Item = (&'a CellRobot, &'a RobotTick, &'a RobotMonitor)> {
        let all = self.monitors.cell().robots.iter().zip(ticks).zip(self.monitors.monitors());
        all.map(|((robot, tick), monitor)| (robot, tick, monitor)).filter(|(robot, ..)| !robot.is_mechanism())
    }
}

/// Arrays of an instant, or of many.
struct Motion<'a> {
    times_s: &'a [f64],
    q: &'a [f64],
    qd: &'a [f64],
    intent: &'a [f64],
    programmed_override: f64,
}

impl<'a> Motion<'a> {
    /// The instant of a row.
    fn at(&self, row: usize) -> CellInstant<'a> {
        let width = self.q.len() / self.times_s.len();
        let of_row = |values: &'a [f64]| values.get(row * width..(row + 1) * width).unwrap_or(&[]);
        CellInstant {
            now_s: self.times_s[row],
            q: of_row(self.q),
            qd: of_row(self.qd),
            intent: of_row(self.intent),
            programmed_override: self.programmed_override,
        }
    }
}

impl Monitor {
    /// The state, for one thread at a time. Call it only where other threads of Python may run, which may hold it.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn region_id(&self, name: &str) -> Result<CellRegionId, Fault> {
        let regions = &self.cell.regions;
        let found = regions.iter().position(|r| r.region.name == name);
        found.map(CellRegionId).ok_or_else(|| {
            let names: Vec<&str> = regions.iter().map(|r| r.region.name.as_str()).collect();
            let help = if names.is_empty() { "a [region.NAME] in the cell file".into() } else { names.join(", ") };
            Fault::Argument(format!("no region is called \"{name}\"\n  write: {help}"))
        })
    }

    fn robot_id(&self, name: &str) -> Result<RobotId, Fault> {
        let robots = &self.cell.robots;
        let found = robots.iter().position(|r| r.name == name && !r.is_mechanism());
        found.map(RobotId).ok_or_else(|| Fault::no_robot(name, &self.robots()))
    }

    /// Values of an optional row.
    fn optional(&self, value: Option<&Bound<'_, PyAny>>, name: &str) -> Result<Vec<f64>, Fault> {
        value.map_or(Ok(Vec::new()), |value| row(value, name, &self.joints))
    }
}

/// What the monitors answered so far, row by row and robot by robot.
#[derive(Default)]
struct Answers {
    overrides: Vec<f64>,
    reasons: Vec<String>,
    events: Vec<(f64, String, Option<String>, &'static str)>,
}

impl Answers {
    /// Ticks through rows of a motion.
    fn add(&mut self, state: &mut State, motion: &Motion<'_>, rows: Range<usize>) {
        for at in rows {
            let (now_s, ticks) = (motion.times_s[at], state.tick(&motion.at(at)));
            for (robot, tick, monitor) in state.guarded(&ticks) {
                self.overrides.push(tick.report.speed_override);
                self.reasons.push(reason(tick, monitor));
                let named = events(tick, monitor).into_iter();
                self.events.extend(named.map(|(region, event)| (now_s, robot.name.clone(), region, event)));
            }
        }
    }
}

fn same_count(times: usize, rows: &Rows<'_>, name: &str) -> Result<(), Fault> {
    if rows.len() == times {
        return Ok(());
    }
    let count = rows.len();
    Err(Fault::Array(format!("`times_s` has {times} values, `{name}` {count} rows\n  write: a time for each row")))
}

/// One row with a value per joint, finite or not: a monitor answers what is not.
fn row(value: &Bound<'_, PyAny>, name: &str, joints: &[String]) -> Result<Vec<f64>, Fault> {
    let wanted = || format!("{} numbers: {}", joints.len(), joints.join(", "));
    let values = numbers(value, name, &wanted)?;
    if values.len() == joints.len() {
        return Ok(values);
    }
    Err(Fault::Array(format!("`{name}` has {} numbers\n  write: {}", values.len(), wanted())))
}

fn numbers(value: &Bound<'_, PyAny>, name: &str, wanted: &dyn Fn() -> String) -> Result<Vec<f64>, Fault> {
    value.extract().map_err(|_| Fault::Array(format!("`{name}` is not a row of numbers\n  write: {}", wanted())))
}

#[pymethods]
impl Monitor {
    #[new]
    fn new(py: Python<'_>, cell: &Bound<'_, Cell>) -> PyResult<Self> {
        let cell = cell.get().model.clone();
        let state = py.detach(|| State::new(cell.clone()))?;
        let joints = joints_of(&cell.robots);
        Ok(Self { cell, state: Mutex::new(state), joints })
    }

    /// The names of the robots that are guarded, in the order of the cell: all but mechanisms.
    #[getter]
    fn robots(&self) -> Vec<&str> {
        let guarded = self.cell.robots.iter().filter(|robot| !robot.is_mechanism());
        guarded.map(|robot| robot.name.as_str()).collect()
    }

    /// The names of the columns of states, `robot.joint`, side by side.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.joints.clone()
    }

    /// The names of the regions.
    #[getter]
    fn regions(&self) -> Vec<&str> {
        self.cell.regions.iter().map(|r| r.region.name.as_str()).collect()
    }

    /// Tick the monitor of every robot.
    ///
    /// Parameters
    /// ----------
    /// now_s
    ///     Present time, in seconds; it grows from tick to tick.
    /// q
    ///     `(dof,)` joint values in the order of `joints`, rad or m.
    /// qd
    ///     `(dof,)` joint velocities; `None`: not known. With the law of stopping distances, and for regions that ride on a
    ///     robot, they are then derived from successive positions, and the first override is 0.
    /// intent
    ///     `(dof,)` joint velocities of the programs at override 1: lets a robot leave that was stopped in front of a region,
    ///     if the cell has `direction_aware`.
    /// programmed_override
    ///     The override of programs and operators, 0 to 1.
    ///
    /// Returns
    /// -------
    /// dict of str to Tick
    ///     By the name of the robot.
    ///
    /// Raises
    /// ------
    /// ArrayError
    ///     If the number of values is not that of the joints.
    #[pyo3(signature = (now_s, q, qd=None, *, intent=None, programmed_override=1.0))]
    fn tick<'py>(
        &self,
        now_s: f64,
        q: &Bound<'py, PyAny>,
        qd: Option<&Bound<'py, PyAny>>,
        intent: Option<&Bound<'py, PyAny>>,
        programmed_override: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = q.py();
        let q = row(q, "q", &self.joints)?;
        let (qd, intent) = (self.optional(qd, "qd")?, self.optional(intent, "intent")?);
        let motion = Motion { times_s: &[now_s], q: &q, qd: &qd, intent: &intent, programmed_override };
        let told: Vec<_> = py.detach(|| {
            let mut state = self.state();
            let ticks = state.tick(&motion.at(0));
            let answer = |(robot, tick, monitor): (&CellRobot, &RobotTick, &RobotMonitor)| {
                let (region, distance_m) = governing(tick, monitor).unzip();
                let told = (tick.report.speed_override, reason(tick, monitor), is_fault(tick));
                (robot.name.clone(), told, region, distance_m, events(tick, monitor))
            };
            state.guarded(&ticks).map(answer).collect()
        });
        py.import("elbowroom.results")?.getattr("Tick")?.getattr("_by_robot")?.call1((told,))
    }

    /// Tick through a motion, such as a recording.
    ///
    /// It goes on from the last tick, so that a motion may come in parts; `reset` begins anew. Rows are checked before the first
    /// tick. An interrupted call leaves the monitors where it was interrupted.
    ///
    /// Parameters
    /// ----------
    /// times_s
    ///     `(N,)`: the times of the rows, growing.
    /// q, qd, intent
    ///     `(N, dof)`: as in `tick`, but every number must be finite.
    /// programmed_override
    ///     The override of programs and operators, 0 to 1.
    /// progress
    ///     Whether to say on standard error how much is done.
    ///
    /// Returns
    /// -------
    /// Overrides
    #[pyo3(signature = (times_s, q, qd=None, *, intent=None, programmed_override=1.0, progress=false))]
    fn evaluate<'py>(
        &self,
        times_s: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
        qd: Option<&Bound<'py, PyAny>>,
        intent: Option<&Bound<'py, PyAny>>,
        programmed_override: f64,
        progress: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = q.py();
        let times_s = numbers(times_s, "times_s", &|| "a time for each row, in seconds".into())?;
        let rows = Rows::of(q, "q", &self.joints)?;
        let other = |value: Option<&Bound<'py, PyAny>>, name| {
            let found = value.map(|value| Rows::of(value, name, &self.joints)).transpose()?;
            found.as_ref().map_or(Ok(()), |found| same_count(times_s.len(), found, name)).map(|()| found)
        };
        let (qd, intent) = (other(qd, "qd")?, other(intent, "intent")?);
        same_count(times_s.len(), &rows, "q")?;
        let all = |rows: Option<&Rows>| rows.map_or(Ok(Vec::new()), Rows::all);
        let (q, qd, intent) = (rows.all()?, all(qd.as_ref())?, all(intent.as_ref())?);
        let motion = Motion { times_s: &times_s, q: &q, qd: &qd, intent: &intent, programmed_override };
        let mut answers = Answers::default();
        let progress = Progress::new(py, progress, rows.len(), "ticks")?;
        for begin in (0..rows.len()).step_by(BETWEEN_SIGNALS) {
            let part = begin..rows.len().min(begin + BETWEEN_SIGNALS);
            let count = part.len();
            py.detach(|| answers.add(&mut self.state(), &motion, part));
            progress.add(py, count)?;
            py.check_signals()?;
        }
        progress.end(py)?;
        let robots: Vec<String> = self.robots().into_iter().map(str::to_owned).collect();
        let overrides = shaped(&PyArray1::from_vec(py, answers.overrides), [rows.len(), robots.len()])?;
        let make = py.import("elbowroom.results")?.getattr("Overrides")?.getattr("_of")?;
        make.call1((robots, PyArray1::from_vec(py, times_s), overrides, answers.reasons, answers.events))
    }

    /// Begin anew, as after the construction: no tick was yet, and every region is as in the file.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| {
            *self.state() = State::new(self.cell.clone())?;
            Ok::<(), Fault>(())
        })?;
        Ok(())
    }

    /// Switch a temporary region on or off, from the next tick on.
    ///
    /// Raises
    /// ------
    /// ArgumentError
    ///     If there is no such region, or it is permanent.
    fn switch(&self, py: Python<'_>, region: &str, on: bool) -> PyResult<()> {
        let id = self.region_id(region)?;
        let switched = py.detach(|| self.state().monitors.switch(id, on, AccessClass::Integrator));
        switched.map_err(|e| Fault::Argument(e.to_string()).into())
    }

    /// Whether a region is switched on.
    fn is_active(&self, py: Python<'_>, region: &str) -> PyResult<bool> {
        self.region_id(region)?;
        let is_active = |monitor: &RobotMonitor| monitor.region(region).is_some_and(|id| monitor.is_active(id));
        Ok(py.detach(|| self.state().monitors.monitors().iter().any(is_active)))
    }

    /// Distance of a robot from a region at the last tick, in metres.
    ///
    /// Returns
    /// -------
    /// float
    ///     0 inside; infinite beyond `limit_m`, and for a region that is off or does not guard against the robot; NaN if the last
    ///     tick did not measure the robot: there was none, or a fault.
    #[pyo3(signature = (robot, region, limit_m=10.0))]
    fn distance(&self, py: Python<'_>, robot: &str, region: &str, limit_m: f64) -> PyResult<f64> {
        if limit_m.is_nan() || limit_m < 0.0 {
            return Err(Fault::Argument(format!("`limit_m` is {limit_m}\n  write: metres, 0 or more")).into());
        }
        let (robot, _) = (self.robot_id(robot)?, self.region_id(region)?);
        Ok(py.detach(|| {
            let state = self.state();
            if !state.measured[robot.0] {
                return f64::NAN;
            }
            let monitor = &state.monitors.monitors()[robot.0];
            let found = monitor.region(region).and_then(|id| monitor.distance(id, limit_m));
            found.unwrap_or(f64::INFINITY)
        }))
    }

    #[expect(clippy::unused_self, reason = "a method of Python")]
    fn __reduce__(&self) -> PyResult<()> {
        let text = "a monitor has a state, so it is not copied\n  write: Monitor(cell) in each process";
        Err(Fault::Argument(text.into()).into())
    }

    fn __repr__(&self) -> String {
        format!("Monitor({:?}: {} robots, {} regions)", self.cell.name, self.robots().len(), self.regions().len())
    }
}

fn is_fault(tick: &RobotTick) -> bool {
    matches!(tick.report.reason, OverrideReason::Fault(_))
}

fn reason(tick: &RobotTick, monitor: &RobotMonitor) -> String {
    tick.report.reason.named(monitor.configuration()).to_string()
}

/// The region that limits the override, and its distance, m.
fn governing(tick: &RobotTick, monitor: &RobotMonitor) -> Option<(String, f64)> {
    let governing = tick.report.governing?;
    Some((monitor.configuration().regions()[governing.region.0].name.clone(), governing.distance_m))
}

fn events(tick: &RobotTick, monitor: &RobotMonitor) -> EventNames {
    let region =
        |event: &elbowroom::monitor::Event| event.region.map(|id| monitor.configuration().regions()[id.0].name.clone());
    tick.events.iter().map(|event| (region(event), event.kind.name())).collect()
}
