//! Commands that measure start themselves again as a release build.

use std::path::Path;
use std::process::Command;

/// Runs `cargo xtask WORDS…` as a release build where this is none. `None`: this is one, go on.
///
/// Nothing is printed: the standard output may be read by a program.
pub fn again(root: &Path, words: &[&str]) -> Option<Result<(), String>> {
    if !cfg!(debug_assertions) {
        return None;
    }
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let mut command = Command::new(cargo);
    command.args(["run", "--quiet", "--release", "--package", "xtask", "--"]).args(words).current_dir(root);
    Some(match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(format!("`{}` as a release build did not end well", words.join(" "))),
        Err(e) => Err(format!("cannot start cargo: {e}")),
    })
}
