//! Compiled programs, as cargo's messages report them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use serde_json::Value;

use crate::shell::command;

/// A compiled program, or a shared library.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Artifact {
    /// The file to start or to load.
    pub executable: PathBuf,
    /// The `Cargo.toml` of its package.
    pub manifest: PathBuf,
    /// Kind of target: `bin`, `lib`, `test`, `bench`.
    pub kind: String,
    /// The name of the target.
    pub name: String,
    /// Whether it is compiled for tests.
    pub is_test: bool,
}

/// Compiles the targets that the words choose, such as `test --no-run`, and returns the programs.
///
/// # Errors
/// If something does not compile; cargo has printed why.
pub fn compile(root: &Path, args: &[&str], env: &[(&str, &str)]) -> Result<Vec<Artifact>, String> {
    let (messages, result) = messages(root, args, "json-render-diagnostics", env)?;
    result.and_then(|()| artifacts(&messages))
}

/// Compiles the same, prints the warnings, and counts them. Cargo keeps them, so nothing is compiled twice.
///
/// # Errors
/// If something does not compile; why has been printed too.
pub fn warnings(root: &Path, args: &[&str], env: &[(&str, &str)]) -> Result<usize, String> {
    let (messages, result) = messages(root, args, "json", env)?;
    let found = warnings_of(&messages)?;
    print!("{}", found.iter().map(String::as_str).collect::<String>());
    result.map(|()| found.len())
}

/// Calls cargo. Returns its messages, one JSON object per line, and whether everything compiles.
fn messages(
    root: &Path,
    args: &[&str],
    format: &str,
    env: &[(&str, &str)],
) -> Result<(String, Result<(), String>), String> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".into());
    let args: Vec<&str> = args.iter().copied().chain(["--message-format", format]).collect();
    let line = args.join(" ");
    eprintln!("$ cargo {line}");
    let mut command = command(&cargo);
    command.args(&args).envs(env.iter().copied()).current_dir(root).stderr(Stdio::inherit());
    let output = command.output().map_err(|e| format!("cannot start cargo: {e}"))?;
    let result = if output.status.success() { Ok(()) } else { Err(format!("`cargo {line}` does not compile")) };
    Ok((String::from_utf8_lossy(&output.stdout).into_owned(), result))
}

/// Compiles a bench as `cargo bench` does, and returns its executable.
///
/// # Errors
/// If it does not compile.
pub fn bench(root: &Path, package: &str, name: &str) -> Result<PathBuf, String> {
    let found = compile(root, &["bench", "--no-run", "-p", package, "--bench", name], &[])?;
    let bench = found.into_iter().find(|artifact| artifact.kind == "bench" && artifact.name == name);
    bench.map(|artifact| artifact.executable).ok_or_else(|| format!("cargo has not built the bench {name}"))
}

/// Reads the programs from cargo's messages.
fn artifacts(messages: &str) -> Result<Vec<Artifact>, String> {
    let mut found = Vec::new();
    for message in objects(messages) {
        let message = message?;
        let Some(executable) = message["executable"].as_str().or_else(|| shared_library(&message)) else { continue };
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        found.push(Artifact {
            executable: executable.into(),
            manifest: text(&message["manifest_path"]).into(),
            kind: text(&message["target"]["kind"][0]),
            name: text(&message["target"]["name"]),
            is_test: message["profile"]["test"] == true,
        });
    }
    Ok(found)
}

/// Reads the warnings and errors of the compiler from cargo's messages. A crate that is compiled twice, for tests and for others, tells
/// some of them twice.
fn warnings_of(messages: &str) -> Result<BTreeSet<String>, String> {
    let mut found = BTreeSet::new();
    for message in objects(messages) {
        let message = message?;
        let text = message["message"]["rendered"].as_str().unwrap_or_default();
        // Summaries of a crate, "3 warnings emitted", have neither a code nor a place; a wrong syntax has no code.
        let is_summary =
            message["message"]["code"].is_null() && message["message"]["spans"].as_array().is_none_or(Vec::is_empty);
        if message["reason"] == "compiler-message" && !is_summary {
            found.insert(text.to_owned());
        }
    }
    Ok(found)
}

fn objects(messages: &str) -> impl Iterator<Item = Result<Value, String>> {
    let lines = messages.lines().filter(|line| line.starts_with('{'));
    lines.map(|line| serde_json::from_str(line).map_err(|e| format!("cargo's message `{line}`: {e}")))
}

/// The shared library of a message.
fn shared_library(message: &Value) -> Option<&str> {
    let files = message["filenames"].as_array()?.iter().filter_map(Value::as_str);
    files.into_iter().find(|file| {
        file.ends_with(std::env::consts::DLL_SUFFIX) && message["target"]["kind"] != serde_json::json!(["proc-macro"])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_are_found_among_the_messages() {
        let messages = concat!(
            r#"{"reason":"compiler-artifact","manifest_path":"/w/c/Cargo.toml","profile":{"test":false},"executable":null,"target":{"kind":["lib"],"name":"c"}}"#,
            "\n   Finished\n",
            r#"{"reason":"compiler-artifact","manifest_path":"/w/m/Cargo.toml","profile":{"test":false},"executable":null,"filenames":["/t/libm.so"],"target":{"kind":["proc-macro"],"name":"m"}}"#,
            "\n",
            r#"{"reason":"compiler-artifact","manifest_path":"/w/d/Cargo.toml","profile":{"test":false},"executable":null,"filenames":["/t/libd.so"],"target":{"kind":["cdylib"],"name":"d"}}"#,
            "\n",
            r#"{"reason":"compiler-artifact","manifest_path":"/w/c/Cargo.toml","profile":{"test":true},"executable":"/t/c-1","target":{"kind":["bench"],"name":"times"}}"#,
            "\n",
            r#"{"reason":"build-finished","success":true}"#
        );
        let library = Artifact {
            executable: "/t/libd.so".into(),
            manifest: "/w/d/Cargo.toml".into(),
            kind: "cdylib".into(),
            name: "d".into(),
            is_test: false,
        };
        let expected = Artifact {
            executable: "/t/c-1".into(),
            manifest: "/w/c/Cargo.toml".into(),
            kind: "bench".into(),
            name: "times".into(),
            is_test: true,
        };
        assert_eq!(artifacts(messages).unwrap(), [library, expected]);
        assert!(artifacts("{not json").is_err());
    }

    #[test]
    fn warnings_are_counted_once() {
        let of = |message: &str| format!(r#"{{"reason":"compiler-message","message":{message}}}"#);
        let unused = of(r#"{"code":{"code":"unused_variables"},"level":"warning","rendered":"warning: unused\n"}"#);
        let summary = of(r#"{"code":null,"level":"warning","rendered":"warning: 1 warning emitted\n"}"#);
        let messages = [unused.as_str(), &summary, &unused, r#"{"reason":"build-finished","success":true}"#].join("\n");
        assert_eq!(warnings_of(&messages).unwrap().into_iter().collect::<Vec<_>>(), ["warning: unused\n"]);
        assert!(warnings_of("{not json").is_err());
    }
}
