//! The programs that the tests are in, as cargo reports them.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

/// A compiled program of tests.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    /// Crate and target, as `proximity/main`; the unit tests of a library are `proximity/lib`.
    pub name: String,
    /// The file to start.
    pub executable: PathBuf,
    /// The folder of its package, in which it is started.
    pub folder: PathBuf,
    /// Whether it understands `--list` and names of tests.
    pub has_harness: bool,
}

/// Compiles the tests that `args` choose, and answers their programs.
///
/// # Errors
/// Where something does not compile; cargo has printed why.
pub fn compile(root: &Path, args: &[&str], env: &[(&str, &str)]) -> Result<Vec<Program>, String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let fixed = ["test", "--no-run", "--message-format", "json-render-diagnostics"];
    let args: Vec<&str> = fixed.iter().chain(args).copied().collect();
    println!("$ cargo {}", args.join(" "));
    let mut command = Command::new(cargo);
    command.args(&args).envs(env.iter().copied()).current_dir(root).stderr(Stdio::inherit());
    let output = command.output().map_err(|e| format!("cannot start cargo: {e}"))?;
    if !output.status.success() {
        return Err("the tests do not compile".into());
    }
    programs(&String::from_utf8_lossy(&output.stdout))
}

/// The programs among cargo's messages, one JSON object a line.
fn programs(messages: &str) -> Result<Vec<Program>, String> {
    let mut found = Vec::new();
    for line in messages.lines().filter(|line| line.starts_with('{')) {
        let message: Value = serde_json::from_str(line).map_err(|e| format!("cargo's message `{line}`: {e}"))?;
        let is_test = message["profile"]["test"] == true;
        let (Some(executable), true) = (message["executable"].as_str(), is_test) else { continue };
        let manifest = PathBuf::from(message["manifest_path"].as_str().unwrap_or_default());
        let folder = manifest.parent().unwrap_or(Path::new("")).to_path_buf();
        let target = message["target"]["name"].as_str().unwrap_or_default();
        let kind = message["target"]["kind"][0].as_str().unwrap_or_default();
        let crate_name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let short = if kind == "test" { target } else { kind };
        let has_harness = kind != "test" || harness(&manifest, target)?;
        found.push(Program {
            name: format!("{crate_name}/{short}"),
            executable: executable.into(),
            folder,
            has_harness,
        });
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
}

/// Whether the test target of the manifest uses the harness of the standard library.
fn harness(manifest: &Path, target: &str) -> Result<bool, String> {
    let text = std::fs::read_to_string(manifest).map_err(|e| format!("{}: {e}", manifest.display()))?;
    let table: toml::Table = text.parse().map_err(|e| format!("{}: {e}", manifest.display()))?;
    let targets = table.get("test").and_then(toml::Value::as_array).into_iter().flatten();
    let named = |t: &&toml::Value| t.get("name").and_then(toml::Value::as_str) == Some(target);
    let own = targets.into_iter().find(named).and_then(|t| t.get("harness")).and_then(toml::Value::as_bool);
    Ok(own.unwrap_or(true))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_of_tests_are_found_among_the_messages() {
        let messages = concat!(
            r#"{"reason":"compiler-artifact","profile":{"test":false},"executable":"/t/elbowroom","target":{"kind":["bin"],"name":"elbowroom"}}"#,
            "\n   Finished\n",
            r#"{"reason":"compiler-artifact","manifest_path":"/w/crates/base/robot/Cargo.toml","profile":{"test":true},"executable":"/t/robot-1","target":{"kind":["lib"],"name":"elbowroom_robot"}}"#,
            "\n",
            r#"{"reason":"build-finished","success":true}"#
        );
        let found = programs(messages).unwrap();
        let expected = Program {
            name: "robot/lib".into(),
            executable: "/t/robot-1".into(),
            folder: "/w/crates/base/robot".into(),
            has_harness: true,
        };
        assert_eq!(found, [expected]);
        assert!(programs("{not json").is_err());
    }
}
