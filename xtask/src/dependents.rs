//! Dependents of packages, from the manifests: the packages that a change of a crate can break.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use toml::{Table, Value};
use xtask::crates::{self, Crate};

/// A package of the workspace, with its manifest.
#[derive(Debug)]
pub struct Package {
    /// Its folder below the root, with a slash at the end.
    pub folder: String,
    /// Its `Cargo.toml`.
    pub manifest: Table,
}

/// Reads every package of the workspace, by its name.
pub fn packages(root: &Path) -> Result<BTreeMap<String, Package>, String> {
    let found = crates::find(root)?.into_iter();
    let crates = found.map(|Crate { group, name, .. }| (crates::package(&name), format!("crates/{group}/{name}/")));
    let tools = [("elbowroom-devtools", "devtools/"), ("xtask", "xtask/")];
    let tools = tools.into_iter().map(|(name, folder)| (name.to_owned(), folder.to_owned()));
    let read = |(name, folder): (String, String)| {
        let manifest = crates::manifest(&root.join(&folder).join("Cargo.toml"))?;
        Ok((name, Package { folder, manifest }))
    };
    crates.chain(tools).map(read).collect()
}

/// Finds the changed packages, all that link them, and those whose tests use one of these; each with its distance in steps.
pub fn dependents(packages: &BTreeMap<String, Package>, changed: BTreeSet<String>) -> BTreeMap<String, usize> {
    let uses = |package: &str, kind: &str, of: &BTreeMap<String, usize>| {
        let used = packages[package].manifest.get(kind).and_then(Value::as_table)?;
        used.keys().filter_map(|used| of.get(used)).min().map(|distance| distance + 1)
    };
    let mut linked: BTreeMap<String, usize> = changed.into_iter().map(|package| (package, 0)).collect();
    loop {
        let is_new = |package: &&String| !linked.contains_key(*package);
        let step = |package: &String| Some((package.clone(), uses(package, "dependencies", &linked)?));
        let more: Vec<(String, usize)> = packages.keys().filter(is_new).filter_map(step).collect();
        if more.is_empty() {
            break;
        }
        linked.extend(more);
    }
    let tested = packages.keys().filter(|package| !linked.contains_key(*package));
    let tested = tested.filter_map(|package| Some((package.clone(), uses(package, "dev-dependencies", &linked)?)));
    let tested: Vec<(String, usize)> = tested.collect();
    linked.extend(tested);
    linked
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_links_a_change_is_affected_and_what_only_tests_with_it_stops_there() {
        let package = |normal: &str, dev: &str| {
            let manifest = format!("[dependencies]\n{normal}\n[dev-dependencies]\n{dev}").parse().unwrap();
            Package { folder: String::new(), manifest }
        };
        let packages: BTreeMap<String, Package> = [
            ("base", package("", "")),
            ("middle", package("base = \"1\"", "")),
            ("above", package("middle = \"1\"", "base = \"1\"")),
            ("tested", package("", "middle = \"1\"")),
            ("beyond", package("tested = \"1\"", "")),
            ("other", package("", "")),
        ]
        .into_iter()
        .map(|(name, package)| (name.to_owned(), package))
        .collect();
        let changed = |name: &str| -> Vec<(String, usize)> {
            dependents(&packages, BTreeSet::from([name.to_owned()])).into_iter().collect()
        };
        let expected = [("above", 2), ("base", 0), ("middle", 1), ("tested", 2)];
        assert_eq!(changed("base"), expected.map(|(name, distance)| (name.to_owned(), distance)));
        assert_eq!(changed("other"), [("other".to_owned(), 0)]);
    }
}
