//! Collision and distance of many states.

use std::num::NonZeroUsize;
use std::sync::Arc;

use elbowroom::Diagnostic;
use elbowroom::cell::QueryModel;
use elbowroom::query::{self, Level, MotionRow, Query, QueryKind, QueryPairs, QueryRow, QueryStates};
use elbowroom::robot::GeometryId;
use elbowroom::scene::CheckerOptions;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{CHUNK, Rows};
use crate::cell::Cell;
use crate::error::Fault;
use crate::kept_checker::KeptChecker;
use crate::model::Model;
use crate::progress::Progress;
use crate::robot::Robot;
use crate::rows::shaped;

/// Rows up to which a call keeps its checker.
const FEW: usize = 16;

/// Collision, distance and tolerance of the states of a robot or a cell.
///
/// The numbers are those of `elbowroom query`, to the bit. All cores work; other threads of Python run meanwhile.
///
/// Parameters
/// ----------
/// source
///     A `Robot`, or a `Cell`, with its objects.
/// level
///     The resolution: `"auto"` (exact), `"L3"`, `"hull"`, `"capsule"`, `"L2"`, `"L2:1"` to `"L2:8"` or `"L1"`. All but the first
///     two are conservative.
/// between
///     Only these pairs, as `"arm,table;arm/link_3,post"`: robots, links, objects, regions.
/// threads
///     The most threads that work; `None`: one per core.
///
/// Raises
/// ------
/// ArgumentError
///     If a word or a name is not known.
/// FileError
///     If the files have no scene to check.
///
/// Examples
/// --------
/// >>> import numpy as np, elbowroom as er
/// >>> checker = er.Checker(er.Robot.load("examples/models/rx60b/rx60b.urdf"))
/// >>> q = np.array([[0, 0, 1.5, 0, 0, 0], [0, 2, 2, 0, 0, 0]], dtype=float)
/// >>> checker.collides(q).tolist()
/// [False, True]
/// >>> checker.within(q, 0.5).tolist()
/// [True, True]
#[pyclass(module = "elbowroom", frozen)]
pub struct Checker {
    model: Arc<Model>,
    source: Py<PyAny>,
    level: String,
    between: Option<String>,
    threads: Option<NonZeroUsize>,
    options: CheckerOptions,
    pairs: QueryPairs,
    kept: KeptChecker,
}

impl Checker {
    fn query(&self, kind: QueryKind) -> Query<'_> {
        let (options, threads) = (self.options, self.threads);
        Query { options, threads, ..Query::new(kind, &self.pairs, &self.model.start) }
    }

    /// Answers a query about every row, block by block.
    fn answer(
        &self,
        q: &Bound<'_, PyAny>,
        kind: QueryKind,
        progress: bool,
        mut take: impl FnMut(&QueryRow) + Send,
    ) -> Result<usize, Fault> {
        let (py, model, query) = (q.py(), &*self.model, self.query(kind));
        let rows = Rows::of(q, "q", &model.columns)?;
        let progress = Progress::new(py, progress, rows.len(), "rows")?;
        for begin in (0..rows.len()).step_by(CHUNK) {
            let states = QueryStates::of_rows(&model.query, rows.chunk(begin)?);
            interruptible(py, &progress, |go_on| {
                query::evaluate_query(&model.scene, &states, &query, &mut |rows| {
                    rows.iter().for_each(&mut take);
                    go_on(rows.len())
                })
                .map(drop)
            })?;
        }
        progress.end(py)?;
        Ok(rows.len())
    }

    /// Sweeps the motion from each row to the one in the same row of the other array.
    fn sweep(
        &self,
        (q0, q1): (&Bound<'_, PyAny>, &Bound<'_, PyAny>),
        progress: bool,
        mut take: impl FnMut(&MotionRow) + Send,
    ) -> Result<(), Fault> {
        let (py, model, query) = (q0.py(), &*self.model, self.query(QueryKind::Time));
        let (from, to) = (Rows::of(q0, "q0", &model.columns)?, Rows::of(q1, "q1", &model.columns)?);
        if from.len() != to.len() {
            let text = format!("`q0` has {} rows, `q1` {}\n  write: as many ends as beginnings", from.len(), to.len());
            return Err(Fault::Array(text));
        }
        let progress = Progress::new(py, progress, from.len(), "motions")?;
        for begin in (0..from.len()).step_by(CHUNK) {
            let states = |rows: &Rows| Ok::<_, Fault>(QueryStates::of_rows(&model.query, rows.chunk(begin)?));
            let (from, to) = (states(&from)?, states(&to)?);
            interruptible(py, &progress, |go_on| {
                query::evaluate_edges(&model.scene, &from, &to, &query, &mut |rows| {
                    rows.iter().for_each(&mut take);
                    go_on(rows.len())
                })
                .map(drop)
            })?;
        }
        Ok(progress.end(py)?)
    }

    /// Answers a query without names about every row; for a few rows by a checker that is kept.
    fn answer_unnamed(
        &self,
        q: &Bound<'_, PyAny>,
        kind: QueryKind,
        progress: bool,
        mut take: impl FnMut(&QueryRow) + Send,
    ) -> Result<(), Fault> {
        let rows = Rows::of(q, "q", &self.model.columns)?;
        if rows.len() <= FEW && !progress {
            let states = QueryStates::of_rows(&self.model.query, rows.all()?);
            let options = (self.options, &self.pairs);
            if let Some(answered) = q.py().detach(|| self.kept.rows(&self.model, options, &states, kind, &mut take)) {
                return answered.map_err(|e| Fault::File(Diagnostic::new(&states.file, None, e)));
            }
        }
        self.answer(q, kind, progress, take).map(drop)
    }

    fn name(&self, pair: Option<(GeometryId, GeometryId)>, side: usize) -> Option<String> {
        pair.map(|(a, b)| self.model.query.geometry_name([a, b][side]))
    }
}

/// Runs work while other threads of Python run. The work calls its argument with the number of rows that it has done, and ends if
/// the answer is false: then a signal has arrived.
fn interruptible(
    py: Python<'_>,
    progress: &Progress,
    work: impl FnOnce(&mut (dyn FnMut(usize) -> bool + Send)) -> Result<(), Diagnostic> + Send,
) -> Result<(), Fault> {
    let mut interrupted = None;
    py.detach(|| {
        work(&mut |done| {
            // The signals of a process arrive at its main thread, which may be this one.
            let told = Python::attach(|py| progress.add(py, done).and_then(|()| signals(py)));
            interrupted = told.err();
            interrupted.is_none()
        })
    })?;
    interrupted.map_or(Ok(()), |error| Err(error.into()))
}

/// Whether a signal, such as that of Ctrl-C, has become an exception.
pub fn signals(py: Python<'_>) -> PyResult<()> {
    py.check_signals()
}

/// The distance of a row, m; infinite if the model has no pair.
fn metres(row: &QueryRow) -> f64 {
    row.distance_m.unwrap_or(f64::INFINITY)
}

#[pymethods]
impl Checker {
    #[new]
    #[pyo3(signature = (source, *, level="auto", between=None, threads=None))]
    fn new(
        source: Bound<'_, PyAny>,
        level: &str,
        between: Option<String>,
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Self> {
        let py = source.py();
        let parsed: Level = level.parse().map_err(|e| Fault::Argument(format!("`level`: {e}")))?;
        let (mut query, cell) = if let Ok(robot) = source.cast::<Robot>() {
            let robot = robot.get();
            (QueryModel::of_robot(robot.path(), (*robot.model).clone()), None)
        } else if let Ok(cell) = source.cast::<Cell>() {
            let cell = cell.get().model.clone();
            (QueryModel::of_cell(&cell), Some(cell))
        } else {
            let class = source.get_type().name().map(|n| n.to_string()).unwrap_or_default();
            let text =
                format!("a {class} has no states to check\n  write: Checker(Robot.load(…)) or Checker(Cell.load(…))");
            return Err(Fault::Argument(text).into());
        };
        let pairs = match &between {
            None => QueryPairs::all(),
            Some(text) => QueryPairs::between(text, &mut query, cell.as_deref())
                .map_err(|e| Fault::Argument(format!("`between`: {e}")))?,
        };
        let model = py.detach(|| Model::new(query))?;
        let options = CheckerOptions { level: parsed, ..CheckerOptions::default() };
        let (source, level) = (source.unbind(), level.to_owned());
        let kept = KeptChecker::default();
        Ok(Self { model: Arc::new(model), source, level, between, threads, options, pairs, kept })
    }

    /// The names of the columns of states: `joint` for a robot, `robot.joint` for a cell, side by side.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.model.columns.clone()
    }

    /// `(dof, 2)`: the least and the largest value of every column, rad or m; infinite without a limit.
    #[getter]
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let chains = self.model.query.robots.iter().map(|robot| &robot.robot.chain);
        let limits = chains.flat_map(|chain| chain.lower().into_iter().zip(chain.upper()));
        let limits: Vec<f64> = limits.flat_map(|(lower, upper)| [lower, upper]).collect();
        let count = limits.len() / 2;
        shaped(&PyArray1::from_vec(py, limits), [count, 2])
    }

    /// The joint values at the start, `(dof,)`.
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let start = self.model.query.robots.iter().flat_map(|robot| robot.start.iter().copied());
        PyArray1::from_vec(py, start.collect())
    }

    /// Find the states in which something collides.
    ///
    /// Parameters
    /// ----------
    /// q
    ///     `(N, dof)` joint values in the order of `joints`.
    /// progress
    ///     Whether to say on standard error how much is done.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     `(N,)` bool.
    #[pyo3(signature = (q, *, progress=false))]
    fn collides<'py>(&self, q: &Bound<'py, PyAny>, progress: bool) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let mut out = Vec::new();
        self.answer_unnamed(q, QueryKind::Collision, progress, |row| out.push(row.collides))?;
        Ok(PyArray1::from_vec(q.py(), out))
    }

    /// Compute the least distance between any two parts that could meet.
    ///
    /// Parameters
    /// ----------
    /// q
    ///     `(N, dof)` joint values in the order of `joints`.
    /// progress
    ///     Whether to say on standard error how much is done.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     `(N,)`, metres: 0 on contact, infinite if there is no pair.
    #[pyo3(signature = (q, *, progress=false))]
    fn distance<'py>(&self, q: &Bound<'py, PyAny>, progress: bool) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut out = Vec::new();
        self.answer_unnamed(q, QueryKind::Distance, progress, |row| out.push(metres(row)))?;
        Ok(PyArray1::from_vec(q.py(), out))
    }

    /// Find the states in which the least distance is at most a tolerance.
    ///
    /// Parameters
    /// ----------
    /// q
    ///     `(N, dof)` joint values in the order of `joints`.
    /// tolerance_m
    ///     The tolerance, metres.
    /// progress
    ///     Whether to say on standard error how much is done.
    ///
    /// Returns
    /// -------
    /// ndarray
    ///     `(N,)` bool.
    #[pyo3(signature = (q, tolerance_m, *, progress=false))]
    fn within<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        tolerance_m: f64,
        progress: bool,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        // Written so that NaN fails.
        if !(tolerance_m >= 0.0 && tolerance_m.is_finite()) {
            let text =
                format!("`tolerance_m` is {tolerance_m}\n  write: a finite number of metres, 0 or more, as 0.02");
            return Err(Fault::Argument(text).into());
        }
        let mut out = Vec::new();
        self.answer_unnamed(q, QueryKind::Tolerance(tolerance_m), progress, |row| out.push(row.collides))?;
        Ok(PyArray1::from_vec(q.py(), out))
    }

    /// Find the nearest pair of every state, and its nearest points.
    ///
    /// Parameters
    /// ----------
    /// q
    ///     `(N, dof)` joint values in the order of `joints`.
    /// progress
    ///     Whether to say on standard error how much is done.
    ///
    /// Returns
    /// -------
    /// Witness
    #[pyo3(signature = (q, *, progress=false))]
    fn witness<'py>(&self, q: &Bound<'py, PyAny>, progress: bool) -> PyResult<Bound<'py, PyAny>> {
        let py = q.py();
        let (mut distances, mut points, mut names) = (Vec::new(), [Vec::new(), Vec::new()], [Vec::new(), Vec::new()]);
        let count = self.answer(q, QueryKind::Distance, progress, |row| {
            distances.push(metres(row));
            let witness = row.witness.map(|(a, b)| [a.to_array(), b.to_array()]);
            for side in 0..2 {
                names[side].push(self.name(row.pair, side));
                points[side].extend(witness.map_or([f64::NAN; 3], |witness| witness[side]));
            }
        })?;
        let [a, b] = names;
        let [on_a, on_b] = points.map(|points| shaped(&PyArray1::from_vec(py, points), [count, 3]));
        let distances = PyArray1::from_vec(py, distances);
        py.import("elbowroom.results")?.getattr("Witness")?.call1((distances, a, b, on_a?, on_b?))
    }

    /// Find out how far straight motions in joint space are free, proven between the states too.
    ///
    /// All joints of a row move at constant rates, all together.
    ///
    /// Parameters
    /// ----------
    /// q0, q1
    ///     `(N, dof)` joint values at the beginnings and at the ends, in the order of `joints`.
    /// progress
    ///     Whether to say on standard error how much is done.
    ///
    /// Returns
    /// -------
    /// Edges
    #[pyo3(signature = (q0, q1, *, progress=false))]
    fn edges<'py>(
        &self,
        q0: &Bound<'py, PyAny>,
        q1: &Bound<'py, PyAny>,
        progress: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = q0.py();
        let (mut shares, mut certain, mut names) = (Vec::new(), Vec::new(), [Vec::new(), Vec::new()]);
        self.sweep((q0, q1), progress, |row| {
            shares.push(row.hit.map_or(1.0, |hit| hit.time));
            certain.push(row.hit.is_none_or(|hit| hit.certain));
            for (side, names) in names.iter_mut().enumerate() {
                names.push(self.name(row.hit.map(|hit| (hit.a, hit.b)), side));
            }
        })?;
        let free: Vec<bool> = names[0].iter().map(Option::is_none).collect();
        let [a, b] = names;
        let (free, certain) = (PyArray1::from_vec(py, free), PyArray1::from_vec(py, certain));
        let shares = PyArray1::from_vec(py, shares);
        py.import("elbowroom.results")?.getattr("Edges")?.call1((free, shares, certain, a, b))
    }

    fn __repr__(&self) -> String {
        let (joints, objects) = (self.model.columns.len(), self.model.query.objects.len());
        format!("Checker({} robots with {joints} joints, {objects} objects)", self.model.query.robots.len())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let args = (&self.source, &self.level, &self.between, self.threads);
        py.import("elbowroom.pickles")?.getattr("reduced_checker")?.call1(args)
    }
}
