//! Other programs, with their output on standard error: standard output is only for the table or the JSON lines.

use std::path::Path;
use std::process::Stdio;

use crate::shell::command;

/// Prints and runs a call; anything except success is an error that names the call.
pub fn run(folder: &Path, words: &[&str], env: &[(&str, &str)]) -> Result<(), String> {
    let call = words.join(" ");
    let shown = if call.len() > 160 { format!("{}…", call.chars().take(160).collect::<String>()) } else { call };
    eprintln!("$ {shown}");
    let (program, args) = words.split_first().ok_or("nothing to run")?;
    let mut command = command(program);
    command.args(args).envs(env.iter().copied()).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::from(std::io::stderr()));
    let status = command.status().map_err(|e| format!("cannot start `{program}`: {e}"))?;
    if status.success() { Ok(()) } else { Err(format!("`{shown}` failed ({status})")) }
}

/// Like [`run`], but the program writes to this process's standard output.
pub fn show(folder: &Path, words: &[&str]) -> Result<(), String> {
    let (program, args) = words.split_first().ok_or("nothing to run")?;
    let mut command = command(program);
    command.args(args).current_dir(folder).stdin(Stdio::null());
    let status = command.status().map_err(|e| format!("cannot start `{program}`: {e}"))?;
    if status.success() { Ok(()) } else { Err(format!("`{program}` failed ({status})")) }
}

/// Whether a program exists.
pub fn exists(program: &str) -> bool {
    let mut command = command(program);
    command.arg("--version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().is_ok()
}

/// Installs packages by apt, as root on Debian and related systems.
pub fn apt(folder: &Path, packages: &[&str]) -> Result<(), String> {
    let quiet = [("DEBIAN_FRONTEND", "noninteractive")];
    let install: Vec<&str> =
        ["apt-get", "install", "-y", "-q", "--no-install-recommends"].iter().chain(packages).copied().collect();
    run(folder, &["apt-get", "update", "-q"], &quiet)
        .and_then(|()| run(folder, &install, &quiet))
        .map_err(|e| format!("{e}; by hand: apt-get install {}", packages.join(" ")))
}

/// The cargo that started this program.
pub fn cargo() -> String {
    std::env::var("CARGO").unwrap_or_else(|_| "cargo".into())
}
