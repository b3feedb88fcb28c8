//! The fuzzy rules of avoidance.

use std::path::PathBuf;

use elbowroom::avoidance::{DEFAULT_RULES, Rules as Model};
use elbowroom::cell::parse_rules;
use elbowroom::formats::Diagnostic;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::Rows;
use crate::error::Fault;
use crate::rows::{map_rows, shaped};

/// The fuzzy rules of avoidance: size and direction of a correction from distance and approach speed.
///
/// `Rules()` are the rules that robots have without others. The file of `rules = "…"` in `[avoidance.ROBOT]` of a cell file has the
/// form of `text`.
///
/// Parameters
/// ----------
/// text
///     Variables and rules in TOML; `None`: the default rules.
///
/// Raises
/// ------
/// ArgumentError
///     If the text is invalid, or its variables are not those of avoidance.
///
/// Examples
/// --------
/// >>> import numpy as np, elbowroom as er
/// >>> size, direction_rad = er.Rules().correction(np.array([0.9, 0.05]), np.array([0.0, 0.3]))
/// >>> bool(size[0] == 0.0), bool(size[1] > 0.8), bool(direction_rad[1] < 0.3)
/// (True, True, True)
#[pyclass(module = "elbowroom", frozen)]
pub struct Rules {
    model: Model,
    text: String,
}

#[pymethods]
impl Rules {
    #[new]
    #[pyo3(signature = (text=None))]
    fn new(text: Option<String>) -> PyResult<Self> {
        let text = text.unwrap_or_else(|| DEFAULT_RULES.to_owned());
        let model = parse_rules("rules", &text).map_err(|e| Fault::Argument(e.to_string()))?;
        Ok(Self { model, text })
    }

    /// Load rules from a file.
    ///
    /// Raises
    /// ------
    /// FileError
    ///     With file, line, and what to write instead.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        let wanted = "a file of rules, such as `elbowroom rules --write FILE` writes";
        let text =
            std::fs::read_to_string(&path).map_err(|e| Fault::File(Diagnostic::unreadable(&path, &e, wanted)))?;
        let model = parse_rules(&path, &text).map_err(Fault::from)?;
        Ok(Self { model, text })
    }

    /// The rules as text, to change and to save.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// The distance beyond which there is no correction, metres.
    #[getter]
    fn reach_m(&self) -> f64 {
        self.model.reach_m()
    }

    /// Compute corrections.
    ///
    /// Parameters
    /// ----------
    /// distance_m
    ///     Distances from obstacles, metres: an array or a number.
    /// approach_m_s
    ///     The speeds at which these come nearer, m/s; what goes away counts as 0. Arrays of other shapes are broadcast.
    ///
    /// Returns
    /// -------
    /// tuple
    ///     Sizes, fractions of the evasion speed from 0 to 1, and directions in radians: 0 is away from the obstacle, π/2
    ///     perpendicular to its motion.
    fn correction<'py>(
        &self,
        distance_m: &Bound<'py, PyAny>,
        approach_m_s: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = distance_m.py();
        let rows = py.import("elbowroom.columns")?.getattr("columns")?.call1((distance_m, approach_m_s))?;
        let (values, shape): (Bound<'py, PyAny>, Bound<'py, PyAny>) = rows.extract()?;
        let wanted = || "(N, 2), float64: distance in metres, approach speed in m/s".to_owned();
        let rows = Rows::of_width(&values, "distance_m, approach_m_s", 2, &wanted)?;
        let found = map_rows(
            py,
            &rows,
            2,
            || (),
            |(), row, out| {
                let correction = self.model.correction(row[0], row[1]);
                out.copy_from_slice(&[correction.size, correction.direction_rad]);
            },
        )?;
        let found = shaped(&found, [rows.len(), 2])?;
        py.import("elbowroom.columns")?.getattr("split")?.call1((found, shape))
    }

    /// The size and the direction of corrections over distance and approach speed. Sizes below 0.001, which `correction` takes for 0,
    /// are as inferred.
    ///
    /// Parameters
    /// ----------
    /// steps
    ///     Number of values per input, at least 2.
    ///
    /// Returns
    /// -------
    /// dict
    ///     `"size"` and `"direction"` (degrees), each the values of the distance in metres `(steps,)`, those of the speed in m/s
    ///     `(steps,)`, and the surface `(steps, steps)` with a row per speed.
    #[pyo3(signature = (steps=41))]
    fn surfaces<'py>(&self, py: Python<'py>, steps: i64) -> PyResult<Bound<'py, PyAny>> {
        let count = usize::try_from(steps).ok().filter(|count| (2..=2000).contains(count));
        let count = count.ok_or_else(|| Fault::Argument(format!("`steps` is {steps}\n  write: 2 to 2000")))?;
        let surfaces = py.detach(|| self.model.surfaces(count));
        let named = PyDict::new(py);
        for surface in surfaces {
            let (x, y) = (PyArray1::from_vec(py, surface.x.clone()), PyArray1::from_vec(py, surface.y.clone()));
            let z = PyArray1::from_vec(py, surface.z.concat());
            named.set_item(&surface.z_name, (x, y, shaped(&z, [surface.y.len(), surface.x.len()])?))?;
        }
        Ok(named.into_any())
    }

    fn __repr__(&self) -> String {
        format!("Rules({} rules)", self.model.controller().rules().len())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> (Bound<'py, PyAny>, (String,)) {
        (slf.get_type().into_any(), (slf.get().text.clone(),))
    }
}
