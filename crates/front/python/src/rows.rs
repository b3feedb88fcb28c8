//! A function of each row, on all cores.

use numpy::ndarray::IntoDimension;
use numpy::{PyArray, PyArray1, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{CHUNK, Rows};
use crate::error::Fault;

/// Rows per core below which another thread costs more than it saves.
const PER_THREAD: usize = 512;

/// Calls `each(worker, row, out)` for every row, `out` being `width` values, with one worker per thread. Returns the values of
/// all rows, one after another.
pub fn map_rows<'py, W: Send>(
    py: Python<'py>,
    rows: &Rows<'py>,
    width: usize,
    worker: impl Fn() -> W + Sync,
    each: impl Fn(&mut W, &[f64], &mut [f64]) + Sync,
) -> Result<Bound<'py, PyArray1<f64>>, Fault> {
    let mut out = vec![0.0; rows.len() * width];
    for (number, place) in out.chunks_mut((CHUNK * width).max(1)).enumerate() {
        let values = rows.chunk(number * CHUNK)?;
        py.detach(|| fill(&values, place, width, &worker, &each));
        py.check_signals()?;
    }
    Ok(PyArray1::from_vec(py, out))
}

fn fill<W: Send>(
    values: &[f64],
    out: &mut [f64],
    width: usize,
    worker: &(impl Fn() -> W + Sync),
    each: &(impl Fn(&mut W, &[f64], &mut [f64]) + Sync),
) {
    let count = out.len() / width;
    let joints = values.len() / count.max(1);
    // Asking for the cores takes tens of microseconds, so few rows do not ask.
    let most = count / PER_THREAD;
    let cores = if most < 2 { 1 } else { std::thread::available_parallelism().map_or(1, usize::from).min(most) };
    let run = |values: &[f64], out: &mut [f64]| {
        let mut own = worker();
        for (row, place) in out.chunks_exact_mut(width).enumerate() {
            each(&mut own, &values[row * joints..(row + 1) * joints], place);
        }
    };
    if cores == 1 {
        return run(values, out);
    }
    let share = count.div_ceil(cores);
    std::thread::scope(|threads| {
        for (part, place) in out.chunks_mut(share * width).enumerate() {
            let values = &values[part * share * joints..];
            threads.spawn(move || run(values, place));
        }
    });
}

/// The same values with more dimensions than one.
pub fn shaped<'py, D: IntoDimension>(
    values: &Bound<'py, PyArray1<f64>>,
    shape: D,
) -> PyResult<Bound<'py, PyArray<f64, D::Dim>>> {
    values.reshape(shape)
}
