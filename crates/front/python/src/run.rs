//! What a run recorded: traces of the robots, and the report.

use std::sync::Arc;

use elbowroom::cell::Cell as Model;
use elbowroom::sim::{Recording, RunOptions, RunSummary, Sample, simulate};
use numpy::PyArray1;
use pyo3::PyClass;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::Fault;
use crate::matrix::values;
use crate::page;
use crate::rows::shaped;

/// What a run recorded, tick by tick; `elbowroom.results.Run` has it.
#[pyclass(module = "elbowroom", frozen)]
pub struct RunRecord {
    model: Arc<Model>,
    recording: Recording,
}

/// Runs the programs of a cell, and returns the `Run` of the package.
///
/// `cell` is the object of Python that has this model.
pub fn run<'py>(
    cell: &Bound<'py, impl PyClass>,
    model: &Arc<Model>,
    options: &RunOptions,
) -> PyResult<Bound<'py, PyAny>> {
    let py = cell.py();
    let outcome = py.detach(|| simulate(model, options).map_err(Fault::from))?;
    let summary = serde_json::to_string(&RunSummary::from(&outcome.recording));
    let summary = summary.map_err(|e| Fault::Argument(format!("the summary of the run: {e}")))?;
    let summary = py.import("json")?.getattr("loads")?.call1((summary,))?;
    let notes: Vec<String> = outcome.notes.iter().map(ToString::to_string).collect();
    let violated = outcome.has_violation();
    let record = RunRecord { model: model.clone(), recording: outcome.recording };
    py.import("elbowroom.results")?.getattr("Run")?.call1((summary, violated, notes, cell, record))
}

#[pymethods]
impl RunRecord {
    /// The names of the robots.
    #[getter]
    fn robots(&self) -> Vec<&str> {
        self.recording.robots.iter().map(|robot| robot.name.as_str()).collect()
    }

    /// The report as an HTML page that needs no network.
    fn page(&self, py: Python<'_>) -> PyResult<String> {
        let label = if self.recording.monitored { "monitor on" } else { "monitor off" };
        Ok(py.detach(|| page::of_recording(&self.model, label, &self.recording))?)
    }

    /// The poses of the objects that move or are gripped, `(N, 4, 4)` by name.
    fn objects<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let by_name = PyDict::new(py);
        for track in &self.recording.objects {
            let poses = PyArray1::from_vec(py, track.poses.iter().flat_map(values).collect());
            by_name.set_item(&track.name, shaped(&poses, [track.poses.len(), 4, 4])?)?;
        }
        Ok(by_name)
    }

    /// Every tick of a robot, as an `elbowroom.results.Trace`.
    fn trace<'py>(&self, py: Python<'py>, robot: &str) -> PyResult<Bound<'py, PyAny>> {
        let track = self.recording.robots.iter().find(|track| track.name == robot);
        let track = track.ok_or_else(|| Fault::no_robot(robot, &self.robots()))?;
        let column = |value: &dyn Fn(&Sample) -> f64| PyArray1::from_vec(py, track.samples.iter().map(value).collect());
        let count = track.samples.len();
        let rows = |values: &dyn Fn(&Sample) -> &[f64]| {
            let all: Vec<f64> = track.samples.iter().flat_map(|sample| values(sample).iter().copied()).collect();
            shaped(&PyArray1::from_vec(py, all), [count, track.joints.len()])
        };
        let (q, qd, intent) = (rows(&|s| &s.q)?, rows(&|s| &s.qd)?, rows(&|s| &s.intent)?);
        let tcp: Vec<f64> = track.samples.iter().flat_map(|sample| sample.tcp.to_array()).collect();
        let tcp = shaped(&PyArray1::from_vec(py, tcp), [count, 3])?;
        let (times, factors) = (column(&|s| s.t_s), column(&|s| s.speed_override));
        let distances = column(&|s| s.distance_m.unwrap_or(f64::NAN));
        let make = py.import("elbowroom.results")?.getattr("Trace")?;
        make.call1((robot, track.joints.clone(), times, q, qd, intent, tcp, factors, distances))
    }
}
