//! Exceptions: their classes are those of `python/elbowroom/errors.py`.

use elbowroom::Diagnostic;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

/// Why a call fails.
#[derive(Debug)]
pub enum Fault {
    /// A file, or the cell that it describes.
    File(Diagnostic),
    /// An array has a wrong shape, type or value.
    Array(String),
    /// Another argument.
    Argument(String),
    /// An exception of Python, such as `KeyboardInterrupt`.
    Python(PyErr),
}

impl Fault {
    /// There is no robot of this name, but these.
    pub fn no_robot(name: &str, known: &[&str]) -> Self {
        let known =
            if known.is_empty() { "a robot in the cell file".into() } else { format!("one of {}", known.join(", ")) };
        Self::Argument(format!("no robot is called \"{name}\"\n  write: {known}"))
    }
}

impl From<Diagnostic> for Fault {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::File(diagnostic)
    }
}

impl From<PyErr> for Fault {
    fn from(error: PyErr) -> Self {
        Self::Python(error)
    }
}

impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        Python::attach(|py| exception(py, fault).unwrap_or_else(|error| error))
    }
}

fn exception(py: Python<'_>, fault: Fault) -> PyResult<PyErr> {
    static FILE: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    static ARRAY: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    static ARGUMENT: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let class = |cell: &'static PyOnceLock<Py<PyType>>, name| cell.import(py, "elbowroom.errors", name);
    Ok(match fault {
        Fault::Array(text) => PyErr::from_type(class(&ARRAY, "ArrayError")?.clone(), text),
        Fault::Argument(text) => PyErr::from_type(class(&ARGUMENT, "ArgumentError")?.clone(), text),
        Fault::Python(error) => error,
        Fault::File(found) => {
            let line = found.line;
            let args = (found.to_string(), found.file.display().to_string(), line, found.message.clone(), found.hint);
            PyErr::from_type(class(&FILE, "FileError")?.clone(), args)
        }
    })
}
