//! `cargo xtask quick`: the checks of what changed, and of what depends on it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use toml::{Table, Value};
use xtask::crates::{self, Crate};
use xtask::shell;

use crate::{documents, layers, suite, test_run};

/// Checks what differs from `since`, a commit: formats, layers, documents, then lints and tests of the changed crates and of
/// all that depend on them.
pub fn run(root: &Path, since: &str) -> Result<(), String> {
    let files = changed(root, since)?;
    println!("{} files differ from {since}", files.len());
    shell::cargo(root, &["fmt", "--all", "--check"], &[])?;
    layers::run(root)?;
    documents::run(root)?;
    let packages = affected(root, &files)?;
    if packages.is_empty() {
        println!("no crate is affected");
        return Ok(());
    }
    println!("affected: {}", packages.join(", "));
    // With `--workspace` the features are those of the whole suite, so that nothing is compiled for this alone.
    let excluded: Vec<String> = all_packages(root)?.into_iter().filter(|name| !packages.contains(name)).collect();
    let chosen: Vec<&str> =
        suite::WORKSPACE.into_iter().chain(excluded.iter().flat_map(|name| ["--exclude", name.as_str()])).collect();
    shell::cargo(root, &[&["clippy"], &chosen[..], &["--all-targets", "--", "-D", "warnings"]].concat(), &[])?;
    test_run::run(root, &chosen, &[])
}

/// Files that differ from a commit, and new ones.
fn changed(root: &Path, since: &str) -> Result<Vec<String>, String> {
    let differing = shell::output(root, "git", &["diff", "--name-only", since])?;
    let new = shell::output(root, "git", &["ls-files", "--others", "--exclude-standard"])?;
    Ok(differing.lines().chain(new.lines()).map(str::to_owned).collect())
}

/// The packages to check again, sorted.
fn affected(root: &Path, files: &[String]) -> Result<Vec<String>, String> {
    let mut manifests = BTreeMap::new();
    let mut folders = Vec::new();
    for Crate { group, name, folder } in crates::find(root)? {
        manifests.insert(crates::package(&name), parse(&folder.join("Cargo.toml"))?);
        folders.push((format!("crates/{group}/{name}/"), crates::package(&name)));
    }
    for (name, package) in [("devtools", "elbowroom-devtools"), ("xtask", "xtask")] {
        manifests.insert(package.to_owned(), parse(&root.join(name).join("Cargo.toml"))?);
        folders.push((format!("{name}/"), package.to_owned()));
    }
    let concerns_all =
        |file: &String| ["Cargo.", ".cargo/", "examples/", "clients/"].iter().any(|s| file.starts_with(s));
    if files.iter().any(concerns_all) {
        return Ok(manifests.into_keys().collect());
    }
    let changed = folders.into_iter().filter(|(folder, _)| files.iter().any(|file| file.starts_with(folder)));
    Ok(dependents(&manifests, changed.map(|(_, package)| package).collect()))
}

fn all_packages(root: &Path) -> Result<Vec<String>, String> {
    let found = crates::find(root)?.into_iter().map(|found| found.package());
    Ok(found.chain(["elbowroom-devtools".to_owned(), "xtask".to_owned()]).collect())
}

/// The changed packages, all that link them, and those whose tests use one of these.
fn dependents(manifests: &BTreeMap<String, Table>, changed: BTreeSet<String>) -> Vec<String> {
    let uses = |package: &str, kind: &str, of: &BTreeSet<String>| {
        let tables = manifests[package].get(kind).and_then(Value::as_table);
        tables.is_some_and(|table| table.keys().any(|used| of.contains(used)))
    };
    let mut linked = changed;
    loop {
        let is_new = |package: &&String| !linked.contains(*package) && uses(package, "dependencies", &linked);
        let more: Vec<String> = manifests.keys().filter(is_new).cloned().collect();
        if more.is_empty() {
            break;
        }
        linked.extend(more);
    }
    manifests.keys().filter(|p| linked.contains(*p) || uses(p, "dev-dependencies", &linked)).cloned().collect()
}

fn parse(path: &Path) -> Result<Table, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    text.parse().map_err(|e| format!("{}: {e}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_links_a_change_is_affected_and_what_only_tests_with_it_stops_there() {
        let manifest = |normal: &str, dev: &str| -> Table {
            format!("[dependencies]\n{normal}\n[dev-dependencies]\n{dev}").parse().unwrap()
        };
        let manifests: BTreeMap<String, Table> = [
            ("base", manifest("", "")),
            ("middle", manifest("base = \"1\"", "")),
            ("tested", manifest("", "middle = \"1\"")),
            ("beyond", manifest("tested = \"1\"", "")),
            ("other", manifest("", "")),
        ]
        .into_iter()
        .map(|(name, table)| (name.to_owned(), table))
        .collect();
        let changed = |name: &str| dependents(&manifests, BTreeSet::from([name.to_owned()]));
        assert_eq!(changed("base"), ["base", "middle", "tested"]);
        assert_eq!(changed("other"), ["other"]);
    }
}
