//! Arrays of NumPy as rows of numbers.

use numpy::{PyReadonlyArray2, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error::Fault;

/// Most rows that are copied at once. A copy, because Python may write to the array while other threads run.
pub const CHUNK: usize = 65_536;

/// Rows of `(N, width)` float64 values.
pub struct Rows<'py> {
    name: &'static str,
    width: usize,
    array: PyReadonlyArray2<'py, f64>,
}

impl<'py> Rows<'py> {
    /// Takes an array with a column per joint, whose names are given for messages.
    pub fn of(value: &Bound<'py, PyAny>, name: &'static str, columns: &[String]) -> Result<Self, Fault> {
        let width = columns.len();
        let wanted = || format!("(N, {width}), float64: a row per state with {}", columns.join(", "));
        Self::of_width(value, name, width, &wanted)
    }

    /// Takes an array of `width` columns; `wanted` says what is in them.
    pub fn of_width(
        value: &Bound<'py, PyAny>,
        name: &'static str,
        width: usize,
        wanted: &dyn Fn() -> String,
    ) -> Result<Self, Fault> {
        let wanted = || format!("an array of shape {}", wanted());
        let Ok(untyped) = value.cast::<PyUntypedArray>() else {
            let class = value.get_type().name().map(|n| n.to_string()).unwrap_or_default();
            return Err(Fault::Array(format!("`{name}` is a {class}, no NumPy array\n  write: {}", wanted())));
        };
        let shape = untyped.shape();
        if shape.len() != 2 || shape[1] != width {
            let shape: Vec<String> = shape.iter().map(usize::to_string).collect();
            let comma = if shape.len() == 1 { "," } else { "" };
            let text = format!("`{name}` has the shape ({}{comma})\n  write: {}", shape.join(", "), wanted());
            return Err(Fault::Array(text));
        }
        let Ok(array) = value.extract::<PyReadonlyArray2<'py, f64>>() else {
            let text = format!("`{name}` has the type {}\n  write: {name}.astype(numpy.float64)", untyped.dtype());
            return Err(Fault::Array(text));
        };
        Ok(Self { name, width, array })
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.array.shape()[0]
    }

    /// Copies all rows, one after another.
    pub fn all(&self) -> Result<Vec<f64>, Fault> {
        let mut values = Vec::with_capacity(self.len() * self.width);
        for begin in (0..self.len()).step_by(CHUNK) {
            values.extend(self.chunk(begin)?);
        }
        Ok(values)
    }

    /// Copies rows from `begin` on, at most [`CHUNK`], one after another.
    pub fn chunk(&self, begin: usize) -> Result<Vec<f64>, Fault> {
        let end = self.len().min(begin + CHUNK);
        let rows = self.array.as_array();
        let rows = rows.slice(numpy::ndarray::s![begin..end, ..]);
        // In the order of rows, whatever the strides.
        let values: Vec<f64> = rows.iter().copied().collect();
        match values.iter().position(|v| !v.is_finite()) {
            None => Ok(values),
            Some(at) => {
                let (row, column, name) = (begin + at / self.width, at % self.width, self.name);
                let text = format!(
                    "`{name}`: row {row}, column {column} is {}\n  write: finite numbers; \
                     {name}[numpy.isfinite({name}).all(axis=1)] leaves out such rows",
                    values[at]
                );
                Err(Fault::Array(text))
            }
        }
    }
}

/// One row of values: a list of numbers or an array of one dimension.
pub fn vector(value: &Bound<'_, PyAny>, name: &str, columns: &[String]) -> Result<Vec<f64>, Fault> {
    let wanted = || format!("{} finite numbers: {}", columns.len(), columns.join(", "));
    let values: Vec<f64> = value
        .extract()
        .map_err(|_| Fault::Array(format!("`{name}` is not a row of numbers\n  write: {}", wanted())))?;
    if values.len() != columns.len() || !values.iter().all(|v| v.is_finite()) {
        return Err(Fault::Array(format!("`{name}` is {values:?}\n  write: {}", wanted())));
    }
    Ok(values)
}
