//! The extension module of the Python package `elbowroom`: robots, cells, checkers, monitors and plans with NumPy arrays.
//!
//! `python/elbowroom` has the package around it: exceptions, type stubs, documentation. Nothing is computed here: arrays
//! become rows of joint values, the façade answers, and the answers become arrays. While the façade works, other threads of
//! Python run. Whether a signal has arrived is checked every 65,536 rows, every block of a query, every 256 ticks and every 20 ms of a
//! search, so Ctrl-C ends a long call.
//!
//! **Invariant.** A row that is not finite, or has the wrong number of values, is an exception that names the row; no such
//! row is ever answered. The one exception is a tick of a monitor, which answers a state that is not finite with override 0.

mod arrays;
mod cell;
mod checker;
mod error;
mod guided_arm;
mod joint_map;
mod kept_checker;
mod matrix;
mod mesh;
mod model;
mod monitor;
mod motion;
mod page;
mod places;
mod planner;
mod progress;
mod reach;
mod robot;
mod rows;
mod rules;
mod run;
mod session;
mod virtual_robot;

use numpy::PyArray1;
use pyo3::prelude::*;

/// The extension module; use the package `elbowroom`.
#[pymodule]
fn _elbowroom(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    // NumPy's interface is found when the first array is made: now, when no signal can come between.
    let _ = PyArray1::<f64>::from_vec(module.py(), Vec::new());
    module.add_class::<robot::Robot>()?;
    module.add_class::<cell::Cell>()?;
    module.add_class::<checker::Checker>()?;
    module.add_class::<monitor::Monitor>()?;
    module.add_class::<reach::ReachQuery>()?;
    module.add_class::<run::RunRecord>()?;
    module.add_class::<guided_arm::GuidedArm>()?;
    module.add_class::<joint_map::MapRecord>()?;
    module.add_class::<planner::Planner>()?;
    module.add_class::<planner::PathRecord>()?;
    module.add_class::<rules::Rules>()?;
    module.add_class::<virtual_robot::VirtualRobot>()?;
    module.add_function(wrap_pyfunction!(motion::time_optimal, module)?)
}
