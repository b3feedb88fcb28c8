//! The tests of the package, which are in Python: `python/tests`, the examples in its documentation, its types.
//!
//! `ELBOWROOM_PYTHON` names an interpreter with numpy, pytest, hypothesis and mypy, and for sweeps pyarrow, Ray, SciPy and
//! matplotlib; without them the tests are left out with a line.

mod package;
mod sweep;
