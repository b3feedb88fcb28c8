//! The Python that some tests compare with.

use std::process::{Command, Stdio};

/// The Python that `ELBOWROOM_PYTHON` names (default `python3`), if it can import these modules, as in `import numpy, coal`.
/// Otherwise prints that the test is skipped, and which packages are missing.
#[allow(clippy::print_stdout, reason = "a skipped test says so")]
pub fn with_modules(modules: &str, packages: &str) -> Option<String> {
    let python = std::env::var("ELBOWROOM_PYTHON").unwrap_or_else(|_| "python3".into());
    let probe = Command::new(&python).args(["-c", &format!("import {modules}")]).stderr(Stdio::null()).status();
    if probe.is_ok_and(|status| status.success()) {
        return Some(python);
    }
    println!("skipped: no {packages} in {python}; name a Python that has them in ELBOWROOM_PYTHON");
    None
}
