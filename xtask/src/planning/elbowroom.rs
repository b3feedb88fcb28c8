//! elbowroom's programs: the command, and the bench that times single states.

use std::path::Path;

use crate::{artifacts, native};

/// Builds and returns `target/release/elbowroom`, or returns the program that `ELBOWROOM` names.
pub fn program(root: &Path) -> Result<String, String> {
    if let Some(named) = std::env::var_os("ELBOWROOM") {
        return Ok(named.to_string_lossy().into_owned());
    }
    native::run(root, &[&native::cargo(), "build", "--release", "-p", "elbowroom-cli"], &[])?;
    Ok(xtask::shell::target_folder(root).join("release/elbowroom").display().to_string())
}

/// Builds and returns the bench that reads the workload.
pub fn state_times(root: &Path) -> Result<String, String> {
    Ok(artifacts::bench(root, "elbowroom-validity", "state_times")?.display().to_string())
}
