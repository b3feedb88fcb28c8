//! Progress of a long call, on standard error.

use pyo3::prelude::*;

/// A line that the package writes, if it is wanted.
pub struct Progress(Option<Py<PyAny>>);

impl Progress {
    /// Begins the line of a call about this many rows, or other units.
    pub fn new(py: Python<'_>, is_wanted: bool, total: usize, unit: &str) -> PyResult<Self> {
        let line = || py.import("elbowroom.progress")?.getattr("Progress")?.call1((true, total, 0, unit));
        Ok(Self(if is_wanted { Some(line()?.unbind()) } else { None }))
    }

    /// Counts finished rows.
    pub fn add(&self, py: Python<'_>, rows: usize) -> PyResult<()> {
        self.0.as_ref().map_or(Ok(()), |line| line.call_method1(py, "add", (rows,)).map(drop))
    }

    /// Ends the line.
    pub fn end(&self, py: Python<'_>) -> PyResult<()> {
        self.0.as_ref().map_or(Ok(()), |line| line.call_method0(py, "end").map(drop))
    }
}
