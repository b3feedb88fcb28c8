//! `cargo xtask quick`: checks of changed crates, and the quick checks of their dependents.

use std::collections::BTreeMap;
use std::path::Path;

use xtask::shell;

use crate::dependents::{self, Package, dependents};
use crate::references::References;
use crate::test_run::{Choice, Program};
use crate::workspace::{self, Compiler, WORKSPACE};
use crate::{documents, layers, suite, test_run};

/// Longest last time, s, of test units that run in crates which only depend on a change.
const LONGEST_BEYOND_S: f64 = 1.0;

/// Checks the changes since the commit `since`: formats, layers, documents, lints, then all tests of the changed crates and
/// the quick tests of their dependents.
pub fn run(root: &Path, since: &str) -> Result<(), String> {
    let files = changed(root, since)?;
    println!("{} files differ from {since}", files.len());
    shell::cargo(root, &["fmt", "--all", "--check"], &[])?;
    layers::run(root)?;
    documents::run(root)?;
    let all = dependents::packages(root)?;
    let packages = affected(&all, &files);
    if packages.is_empty() {
        println!("no crate is affected");
        return Ok(());
    }
    println!("affected: {}", packages.keys().map(String::as_str).collect::<Vec<_>>().join(", "));
    // The whole workspace: unchanged crates cost nothing, and in a part of it libraries would have other features.
    workspace::lint(root, &[])?;
    suite::announce_data(root);
    let references = References::find(root, true)?;
    let distance = |program: &Program| {
        let package = packages.iter().find(|(name, _)| root.join(&all[*name].folder) == program.folder);
        package.map(|(_, distance)| *distance)
    };
    let longest = |program: &Program| match distance(program) {
        None => -1.0,
        Some(0) => f64::INFINITY,
        Some(_) => LONGEST_BEYOND_S,
    };
    let choice = Choice { longest: &longest, again: false };
    let compiler = Compiler::find(root);
    let env: Vec<_> = compiler.environment().into_iter().chain(references.environment()).collect();
    test_run::run(root, &WORKSPACE, &env, &choice, || ())
}

/// Lists files that differ from a commit, and new ones.
fn changed(root: &Path, since: &str) -> Result<Vec<String>, String> {
    let differing = shell::output(root, "git", &["diff", "--name-only", since])?;
    let new = shell::output(root, "git", &["ls-files", "--others", "--exclude-standard"])?;
    Ok(differing.lines().chain(new.lines()).map(str::to_owned).collect())
}

/// Returns the packages to check again, each with its distance in steps from a change.
fn affected(packages: &BTreeMap<String, Package>, files: &[String]) -> BTreeMap<String, usize> {
    let concerns_all = |file: &String| {
        ["Cargo.", ".cargo/", "clippy.toml", "rustfmt.toml", "examples/", "clients/"]
            .iter()
            .any(|s| file.starts_with(s))
    };
    if files.iter().any(concerns_all) {
        return packages.keys().map(|name| (name.clone(), 0)).collect();
    }
    let is_changed = |package: &Package| files.iter().any(|file| file.starts_with(&package.folder));
    let changed = packages.iter().filter(|(_, package)| is_changed(package)).map(|(name, _)| name.clone());
    dependents(packages, changed.collect())
}
