//! `cargo xtask quick`: the checks of what changed, and of what depends on it.

use std::collections::BTreeMap;
use std::path::Path;

use xtask::shell;

use crate::dependents::{self, Package, dependents};
use crate::references::References;
use crate::test_run::Program;
use crate::workspace::WORKSPACE;
use crate::{documents, layers, suite, test_run};

/// Checks what differs from `since`, a commit: formats, layers, documents, then lints and tests of the changed crates and of
/// all that depend on them.
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
    println!("affected: {}", packages.join(", "));
    // The whole workspace: what has not changed costs nothing, and with a part of it libraries would have other features.
    shell::cargo(root, &[&["clippy"], &WORKSPACE[..], &["--all-targets", "--", "-D", "warnings"]].concat(), &[])?;
    suite::announce_data(root);
    let references = References::find(root, true)?;
    let folders: Vec<_> = packages.iter().map(|name| root.join(&all[name].folder)).collect();
    let is_chosen = |program: &Program| folders.contains(&program.folder);
    test_run::run(root, &WORKSPACE, &references.environment().collect::<Vec<_>>(), is_chosen)
}

/// Files that differ from a commit, and new ones.
fn changed(root: &Path, since: &str) -> Result<Vec<String>, String> {
    let differing = shell::output(root, "git", &["diff", "--name-only", since])?;
    let new = shell::output(root, "git", &["ls-files", "--others", "--exclude-standard"])?;
    Ok(differing.lines().chain(new.lines()).map(str::to_owned).collect())
}

/// The packages to check again, sorted.
fn affected(packages: &BTreeMap<String, Package>, files: &[String]) -> Vec<String> {
    let concerns_all = |file: &String| {
        ["Cargo.", ".cargo/", "clippy.toml", "rustfmt.toml", "examples/", "clients/"]
            .iter()
            .any(|s| file.starts_with(s))
    };
    if files.iter().any(concerns_all) {
        return packages.keys().cloned().collect();
    }
    let is_changed = |package: &Package| files.iter().any(|file| file.starts_with(&package.folder));
    let changed = packages.iter().filter(|(_, package)| is_changed(package)).map(|(name, _)| name.clone());
    dependents(packages, changed.collect()).into_keys().collect()
}
