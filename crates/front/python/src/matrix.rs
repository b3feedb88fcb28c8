//! Poses as 4x4 arrays.

use elbowroom::spatial::Pose;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::rows::shaped;

/// The numbers of a 4x4 array, row by row.
pub fn values(pose: &Pose) -> [f64; 16] {
    let mut values = [0.0; 16];
    values[..12].copy_from_slice(pose.to_rows().as_flattened());
    values[15] = 1.0;
    values
}

/// A pose as a 4x4 array.
pub fn matrix<'py>(py: Python<'py>, pose: &Pose) -> PyResult<Bound<'py, PyArray2<f64>>> {
    shaped(&PyArray1::from_vec(py, values(pose).to_vec()), [4, 4])
}
