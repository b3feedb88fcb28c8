//! The one set of features with which the tests are compiled, and the resulting programs.

use std::path::{Path, PathBuf};

use xtask::shell::{self, target_folder};

/// All tests run with the network in the command. A second set of features would compile much of the workspace twice.
pub const WORKSPACE: [&str; 3] = ["--workspace", "--features", "elbowroom-cli/live"];

/// Builds a program of the workspace as the tests use it. With `--tests` its libraries have the features that they have
/// for the tests, so that only the program itself is left to compile.
pub fn program(root: &Path, name: &str) -> Result<PathBuf, String> {
    let build = [&["build", "--quiet", "--tests", "--bins"], &WORKSPACE[..]].concat();
    shell::cargo(root, &build, &[])?;
    Ok(target_folder(root).join("debug").join(name))
}
