//! Our own side: the program, and the example that times single states.

use std::path::Path;

use crate::native;

const EXAMPLE: &str = "crates/world/validity/examples/state_times.rs";

/// `target/release/elbowroom`, built; or what `ELBOWROOM` names.
pub fn program(root: &Path) -> Result<String, String> {
    if let Some(named) = std::env::var_os("ELBOWROOM") {
        return Ok(named.to_string_lossy().into_owned());
    }
    native::run(root, &[&native::cargo(), "build", "--release", "-p", "elbowroom-cli"], &[])?;
    Ok(root.join("target/release/elbowroom").display().to_string())
}

/// The example that reads the workload, built.
pub fn state_times(root: &Path) -> Result<String, String> {
    if !root.join(EXAMPLE).is_file() {
        return Err(format!("{EXAMPLE} is not there; xtask/planning/README.md says what it reads and prints"));
    }
    let build = [&native::cargo(), "build", "--release", "-p", "elbowroom-validity", "--example", "state_times"];
    native::run(root, &build, &[])?;
    Ok(root.join("target/release/examples/state_times").display().to_string())
}
