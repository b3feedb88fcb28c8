//! `elbowroom sweep`: hands a task to the Python package, which has the cluster.

use std::ffi::OsString;
use std::process::Command;

use crate::args::SweepArgs;
use crate::output::{ExitStatus, Failure};

/// Names the interpreter; without it `python3` of the search path.
const PYTHON: &str = "ELBOWROOM_PYTHON";

pub(crate) fn sweep(args: &SweepArgs) -> Result<ExitStatus, Failure> {
    let python = std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into());
    check(&python)?;
    let mut run = Command::new(&python);
    run.args(["-m", "elbowroom.sweep"]).arg(&args.task);
    if let Some(out) = &args.out {
        run.arg("--out").arg(out);
    }
    if let Some(executor) = &args.executor {
        run.arg("--executor").arg(executor);
    }
    let status = run.status().map_err(|e| Failure::Wrong(format!("{}: {e}", python.display())))?;
    if status.success() {
        return Ok(ExitStatus::Success);
    }
    Err(Failure::Wrong(format!("{}: the sweep has not ended ({status})", args.task.display())))
}

/// Whether the interpreter has the package and what it writes with.
fn check(python: &OsString) -> Result<(), Failure> {
    let what = format!(
        "install CPython 3.11 or later and `pip install 'elbowroom[sweep]'`, or name another interpreter in {PYTHON}"
    );
    let probe = Command::new(python).args(["-c", "import elbowroom.sweep, pyarrow"]).output();
    let probe = probe.map_err(|e| Failure::Wrong(format!("{}: no Python: {e}\n  write: {what}", python.display())))?;
    if probe.status.success() {
        return Ok(());
    }
    let told = String::from_utf8_lossy(&probe.stderr);
    let reason = told.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("it cannot import the package");
    Err(Failure::Wrong(format!("{}: {reason}\n  write: {what}", python.display())))
}
