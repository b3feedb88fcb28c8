//! Command line: failures, options, and the folders that it refers to.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Why a command failed, as text to print.
#[derive(Debug)]
pub enum Failure {
    /// A check found something: exit 1.
    Check(String),
    /// The command line is wrong: exit 2.
    Usage(String),
}

impl From<String> for Failure {
    fn from(message: String) -> Self {
        Self::Check(message)
    }
}

/// Prints why a command failed, with its help if the call was wrong, and returns the exit status.
pub fn exit(result: Result<(), Failure>, help: &str) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Check(message)) => {
            eprintln!("error: {message}");
            ExitCode::from(1)
        }
        Err(Failure::Usage(message)) => {
            eprintln!("error: {message}\n\n{help}");
            ExitCode::from(2)
        }
    }
}

/// Parses the value of an option that is a count.
///
/// # Errors
/// Anything except a whole number of 1 or more.
pub fn count(option: &str, value: &str) -> Result<usize, String> {
    let number = value.parse().ok().filter(|n| *n > 0);
    number.ok_or_else(|| format!("`{option} {value}`: write a whole number of 1 or more"))
}

/// Folder of the real robots: `given`, or `$ELBOWROOM_DATA`, or beside the workspace.
pub fn data_folder(root: &Path, given: Option<&Path>) -> PathBuf {
    let given = given.map(Path::to_path_buf).or_else(|| std::env::var_os("ELBOWROOM_DATA").map(PathBuf::from));
    given.unwrap_or_else(|| root.join("../shared/data"))
}

/// Root of the workspace, wherever the command was started.
///
/// # Errors
/// If the manifest of this package has no folder above it.
pub fn workspace_root() -> Result<PathBuf, String> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().map(Path::to_path_buf).ok_or_else(|| format!("{} has no parent directory", here.display()))
}
