//! Calls of other programs: each call is printed before it runs.

use std::path::Path;
use std::process::Command;

/// Makes a command for a program, without cargo's variables about this package: build scripts that read them (of
/// `ring`) would run again at each change between `cargo test` and `cargo xtask`, and all dependents would be compiled
/// again.
pub fn command(program: &str) -> Command {
    let mut command = Command::new(program);
    let of_package = |name: &str| name.starts_with("CARGO_PKG_") || name.starts_with("CARGO_MANIFEST_");
    for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_str().is_some_and(of_package)) {
        command.env_remove(name);
    }
    command
}

/// Runs `program args…` in `root` with extra environment.
///
/// # Errors
/// An exit status other than 0.
pub fn run(root: &Path, program: &str, args: &[&str], env: &[(&str, &str)]) -> Result<(), String> {
    match status(root, program, args, env)? {
        0 => Ok(()),
        code => Err(format!("`{}` ended with exit status {code}", line(program, args, &[]))),
    }
}

/// Like [`run`], for the cargo that started this program.
///
/// # Errors
/// An exit status other than 0.
pub fn cargo(root: &Path, args: &[&str], env: &[(&str, &str)]) -> Result<(), String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    println!("$ {}", line("cargo", args, env));
    match wait(root, &cargo, args, env)? {
        0 => Ok(()),
        code => Err(format!("`{}` ended with exit status {code}", line("cargo", args, &[]))),
    }
}

/// Like [`cargo`], but silent; returns the exit status.
///
/// # Errors
/// If cargo does not start.
pub fn cargo_status(root: &Path, args: &[&str], env: &[(&str, &str)]) -> Result<i32, String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    wait(root, &cargo, args, env)
}

/// Prints and runs a call; returns the exit status, -1 if a signal ended the program.
///
/// # Errors
/// If the program does not start.
pub fn status(root: &Path, program: &str, args: &[&str], env: &[(&str, &str)]) -> Result<i32, String> {
    println!("$ {}", line(program, args, env));
    wait(root, program, args, env)
}

/// Returns the output of `program args…`.
///
/// # Errors
/// An exit status other than 0, with the standard error of the program.
pub fn output(root: &Path, program: &str, args: &[&str]) -> Result<String, String> {
    output_with(root, program, args, &[])
}

/// Like [`output`], with more environment variables.
///
/// # Errors
/// As for [`output`].
pub fn output_with(root: &Path, program: &str, args: &[&str], env: &[(&str, &str)]) -> Result<String, String> {
    let output = command(program).args(args).envs(env.iter().copied()).current_dir(root).output();
    let output = output.map_err(|e| format!("cannot start `{program}`: {e}"))?;
    if !output.status.success() {
        return Err(format!("`{}` failed:\n{}", line(program, args, env), String::from_utf8_lossy(&output.stderr)));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Whether `program args…` runs and succeeds; prints nothing.
pub fn succeeds(root: &Path, program: &str, args: &[&str]) -> bool {
    let output = command(program).args(args).current_dir(root).output();
    output.is_ok_and(|output| output.status.success())
}

fn wait(root: &Path, program: &str, args: &[&str], env: &[(&str, &str)]) -> Result<i32, String> {
    let mut command = command(program);
    command.args(args).current_dir(root).envs(env.iter().copied());
    let status = command.status().map_err(|e| format!("cannot start `{program}`: {e}"))?;
    Ok(status.code().unwrap_or(-1))
}

fn line(program: &str, args: &[&str], env: &[(&str, &str)]) -> String {
    let settings = env.iter().map(|(key, value)| format!("{key}={value}"));
    let words = std::iter::once(program).chain(args.iter().copied()).map(quoted);
    settings.chain(words).collect::<Vec<_>>().join(" ")
}

fn quoted(word: &str) -> String {
    if word.is_empty() || word.contains([' ', '\n', '"', '$', '*']) { format!("'{word}'") } else { word.to_owned() }
}

/// Folder of cargo's build output.
pub fn target_folder(root: &Path) -> std::path::PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), |folder| root.join(folder))
}

/// Makes a folder and its parents.
///
/// # Errors
/// If that fails; the message names the folder.
pub fn make_folder(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))
}
