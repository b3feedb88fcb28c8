//! Test programs, as cargo reports them.

use std::path::{Path, PathBuf};

use xtask::crates;

use crate::artifacts::{self, Artifact};
use crate::workspace::TESTS;

/// A compiled test program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    /// Crate and target, as `proximity/main`; the unit tests of a library are `proximity/lib`.
    pub name: String,
    /// The file to start.
    pub executable: PathBuf,
    /// Programs and shared libraries of its package, which its tests start or load.
    pub started: Vec<PathBuf>,
    /// The folder of its package, in which it is started.
    pub folder: PathBuf,
    /// Whether it understands `--list` and names of tests.
    pub has_harness: bool,
}

/// Compiles the tests that `args` choose, and returns their programs.
///
/// # Errors
/// If something does not compile; cargo has printed why.
pub fn compile(root: &Path, args: &[&str], env: &[(&str, &str)]) -> Result<Vec<Program>, String> {
    programs(&artifacts::compile(root, &[&TESTS[..], args].concat(), env)?)
}

/// Selects the test programs.
fn programs(artifacts: &[Artifact]) -> Result<Vec<Program>, String> {
    let mut found = Vec::new();
    for Artifact { executable, manifest, kind, name, .. } in artifacts.iter().filter(|artifact| artifact.is_test) {
        let folder = manifest.parent().unwrap_or(Path::new("")).to_path_buf();
        let crate_name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let is_integration = kind == "test";
        let short = if is_integration { name } else { kind };
        let has_harness = !is_integration || harness(manifest, name)?;
        let of_package = artifacts.iter().filter(|other| !other.is_test && other.manifest == *manifest);
        found.push(Program {
            name: format!("{crate_name}/{short}"),
            executable: executable.clone(),
            started: of_package.map(|other| other.executable.clone()).collect(),
            folder,
            has_harness,
        });
    }
    found.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(found)
}

/// Whether the test target of the manifest uses the harness of the standard library.
fn harness(manifest: &Path, target: &str) -> Result<bool, String> {
    let table = crates::manifest(manifest)?;
    let targets = table.get("test").and_then(toml::Value::as_array).into_iter().flatten();
    let named = |t: &&toml::Value| t.get("name").and_then(toml::Value::as_str) == Some(target);
    let own = targets.into_iter().find(named).and_then(|t| t.get("harness")).and_then(toml::Value::as_bool);
    Ok(own.unwrap_or(true))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn programs_of_tests_are_found_among_the_artifacts() {
        let artifact = |executable: &str, kind: &str, is_test| Artifact {
            executable: executable.into(),
            manifest: "/w/crates/base/robot/Cargo.toml".into(),
            kind: kind.into(),
            name: "elbowroom_robot".into(),
            is_test,
        };
        let found = programs(&[artifact("/t/elbowroom", "bin", false), artifact("/t/robot-1", "lib", true)]).unwrap();
        let expected = Program {
            name: "robot/lib".into(),
            executable: "/t/robot-1".into(),
            started: vec!["/t/elbowroom".into()],
            folder: "/w/crates/base/robot".into(),
            has_harness: true,
        };
        assert_eq!(found, [expected]);
    }
}
