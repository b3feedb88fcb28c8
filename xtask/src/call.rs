//! A command line: how it failed, its options, the folders that it means.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Why a command did not end well, in the words to print.
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

/// Prints why a command failed, with its help where the call was wrong, and answers the exit status.
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

/// The value of an option that counts something.
///
/// # Errors
/// Anything but a whole number of 1 or more.
pub fn count(option: &str, value: &str) -> Result<usize, String> {
    let number = value.parse().ok().filter(|n| *n > 0);
    number.ok_or_else(|| format!("`{option} {value}`: write a whole number of 1 or more"))
}

/// Where the real robots are: `given`, or `$ELBOWROOM_DATA`, or beside the workspace.
pub fn data_folder(root: &Path, given: Option<&Path>) -> PathBuf {
    let given = given.map(Path::to_path_buf).or_else(|| std::env::var_os("ELBOWROOM_DATA").map(PathBuf::from));
    given.unwrap_or_else(|| root.join("../shared/data"))
}

/// The root of the workspace, wherever the command was started.
///
/// # Errors
/// Where the manifest of this package has no folder above it.
pub fn workspace_root() -> Result<PathBuf, String> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().map(Path::to_path_buf).ok_or_else(|| format!("{} has no parent directory", here.display()))
}
