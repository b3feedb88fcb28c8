//! Allowed dependencies. The order of [`GROUPS`] is the architecture; `docs/architecture.md` explains it.
//!
//! The files of a crate must not use each other in a cycle. A ratchet limits sizes, and public items that nothing
//! reaches. The list of planted faults must fit the sources.

mod circles;
mod module;
mod ratchet;
mod source;
mod uses;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use toml::{Table, Value};
use xtask::crates::{self, Crate, GROUPS};

use crate::faults;

/// Crates that may opt out of `forbid(unsafe_code)`: the interfaces for C and Python need it. They must deny it, so that each
/// module that allows it is seen.
const MAY_USE_UNSAFE: [&str; 2] = ["capi", "python"];

/// Forbidden dependencies, also through other crates: (crate, dependency, reason).
const NEVER: [(&str, &str, &str); 3] = [
    ("monitor", "avoidance", "avoidance proposes a motion, the monitor scales it last"),
    ("monitor", "planner", "a planner can fail; the monitor must not be affected"),
    ("monitor", "scene", "the monitor links only what its tick runs; the scene checker allocates"),
];

/// Checks the workspace at `root` and prints the result.
pub fn run(root: &Path) -> Result<(), String> {
    check(root, false)
}

/// Lowers and removes exceptions of the ratchet that are too large, then checks like [`run`].
pub fn write(root: &Path) -> Result<(), String> {
    check(root, true)
}

fn check(root: &Path, write: bool) -> Result<(), String> {
    let workspace = crates::manifest(&root.join("Cargo.toml"))?;
    let found = crates::find(root)?;
    let mut manifests = BTreeMap::new();
    for found in &found {
        manifests.insert(found.name.clone(), crates::manifest(&found.folder.join("Cargo.toml"))?);
    }
    let mut problems = problems(&workspace, &manifests);
    for found in &found {
        problems.extend(place_problem(found));
        problems.extend(circle_problems(&found.name, &found.folder.join("src"))?);
    }
    for name in ["devtools", "xtask"] {
        problems.extend(circle_problems(name, &root.join(name).join("src"))?);
    }
    problems.extend(faults::problems(root)?);
    let ratchet = ratchet::check(root, &manifests, write)?;
    problems.extend(ratchet.problems);
    if problems.is_empty() {
        println!("layers: {} crates, every dependency points to a lower layer, 0 circles of files", manifests.len());
        println!(
            "ratchet: {} exceptions in xtask/ratchet.toml, 0 public items that nothing reaches",
            ratchet.exceptions
        );
        return Ok(());
    }
    Err(format!("the layers, or the list of faults, are broken\n  {}", problems.join("\n  ")))
}

fn circle_problems(name: &str, src: &Path) -> Result<Vec<String>, String> {
    let circles = circles::circles_of(src)?;
    Ok(circles.iter().map(|lines| format!("{name}: a circle of files\n    {}", lines.join("\n    "))).collect())
}

/// Lists everything that is wrong with these manifests (crate name → its `Cargo.toml`), in a fixed order.
fn problems(workspace: &Table, manifests: &BTreeMap<String, Table>) -> Vec<String> {
    let mut found = Vec::new();
    if lookup(workspace, &["workspace", "lints", "rust", "unsafe_code"]).and_then(Value::as_str) != Some("forbid") {
        found.push("Cargo.toml: [workspace.lints.rust] must say unsafe_code = \"forbid\"".into());
    }
    let uses: BTreeMap<&str, BTreeSet<String>> =
        manifests.iter().map(|(name, manifest)| (name.as_str(), crates_used(manifest))).collect();
    for (name, manifest) in manifests {
        found.extend(name_problems(name, manifest));
        found.extend(lint_problem(name, manifest));
        found.extend(order_problems(name, &uses[name.as_str()]));
    }
    let links: BTreeMap<&str, BTreeSet<String>> =
        manifests.iter().map(|(name, manifest)| (name.as_str(), crates_linked(manifest))).collect();
    for (who, whom, why) in NEVER {
        if reaches(&links, who, whom, &mut BTreeSet::new()) {
            found.push(format!("{who} must not depend on {whom}, directly or through others: {why}"));
        }
    }
    found
}

/// Says in which group the crate is, if that is the wrong one.
fn place_problem(found: &Crate) -> Option<String> {
    let (group, _) = GROUPS.iter().find(|(_, crates)| crates.contains(&found.name.as_str()))?;
    (found.group != *group)
        .then(|| format!("crates/{}/{}: the crate belongs to crates/{group}", found.group, found.name))
}

fn name_problems(name: &str, manifest: &Table) -> Option<String> {
    let package = lookup(manifest, &["package", "name"]).and_then(Value::as_str).unwrap_or_default();
    let expected = crates::package(name);
    (package != expected).then(|| format!("{name}: the package is called `{package}`, not `{expected}`"))
}

fn lint_problem(name: &str, manifest: &Table) -> Option<String> {
    if MAY_USE_UNSAFE.contains(&name) {
        let level = lookup(manifest, &["lints", "rust", "unsafe_code"]).and_then(Value::as_str);
        return (level != Some("deny")).then(|| {
            format!("{name}: [lints.rust] in Cargo.toml must say unsafe_code = \"deny\", and modules allow it")
        });
    }
    let opted_in = lookup(manifest, &["lints", "workspace"]).and_then(Value::as_bool) == Some(true);
    (!opted_in)
        .then(|| format!("{name}: add `[lints]` to Cargo.toml, with `workspace = true` (it forbids unsafe code)"))
}

fn order_problems(name: &str, uses: &BTreeSet<String>) -> Vec<String> {
    let Some(layer) = layer_of(name) else {
        return vec![format!(
            "{name} is not in GROUPS of xtask/src/crates.rs: add it there, at its layer, and to docs/architecture.md"
        )];
    };
    let too_high = uses.iter().filter(|used| layer_of(used).is_none_or(|other| other >= layer));
    too_high.map(|used| format!("{name} depends on {used}, which is not a lower layer")).collect()
}

fn layer_of(name: &str) -> Option<usize> {
    GROUPS.iter().flat_map(|(_, crates)| *crates).position(|&layer| layer == name)
}

fn reaches(uses: &BTreeMap<&str, BTreeSet<String>>, from: &str, to: &str, seen: &mut BTreeSet<String>) -> bool {
    let Some(used) = uses.get(from) else { return false };
    used.iter().any(|next| next == to || (seen.insert(next.clone()) && reaches(uses, next, to, seen)))
}

/// Crates of this workspace named by any dependency table, including those of tests, build scripts and single targets.
fn crates_used(manifest: &Table) -> BTreeSet<String> {
    crates_in(manifest, &["dependencies", "dev-dependencies", "build-dependencies"])
}

/// Crates of this workspace that a program links if it uses the crate.
fn crates_linked(manifest: &Table) -> BTreeSet<String> {
    crates_in(manifest, &["dependencies"])
}

fn crates_in(manifest: &Table, kinds: &[&str]) -> BTreeSet<String> {
    let mut tables = vec![manifest];
    if let Some(targets) = manifest.get("target").and_then(Value::as_table) {
        tables.extend(targets.values().filter_map(Value::as_table));
    }
    let sections = tables.iter().flat_map(|table| kinds.iter().filter_map(|kind| table.get(*kind)?.as_table()));
    sections.flatten().filter_map(|(key, value)| crate_of_dependency(key, value)).collect()
}

fn crate_of_dependency(key: &str, value: &Value) -> Option<String> {
    let package = value.get("package").and_then(Value::as_str).unwrap_or(key);
    if package == "elbowroom" {
        return Some(package.to_owned());
    }
    package.strip_prefix("elbowroom-").map(str::to_owned)
}

fn lookup<'a>(table: &'a Table, keys: &[&str]) -> Option<&'a Value> {
    let (first, rest) = keys.split_first()?;
    rest.iter().try_fold(table.get(*first)?, |value, key| value.get(*key))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn workspace() -> Table {
        "[workspace.lints.rust]\nunsafe_code = \"forbid\"".parse().unwrap()
    }

    fn manifest(name: &str, rest: &str) -> (String, Table) {
        let text = format!("[package]\nname = \"elbowroom-{name}\"\n[lints]\nworkspace = true\n{rest}");
        (name.to_owned(), text.parse().unwrap())
    }

    fn check(manifests: impl IntoIterator<Item = (String, Table)>) -> Vec<String> {
        problems(&workspace(), &manifests.into_iter().collect())
    }

    #[test]
    fn a_sound_order_passes() {
        let crates = [
            manifest("spatial", "[dependencies]\nglam = \"1\""),
            manifest("monitor", "[dependencies]\nelbowroom-spatial.workspace = true"),
            manifest("cell", "[dev-dependencies]\nelbowroom-monitor = { path = \"../monitor\" }"),
        ];
        assert_eq!(check(crates), Vec::<String>::new());
    }

    #[test]
    fn a_dependency_on_a_higher_layer_is_found_in_every_kind_of_table() {
        let tables = [
            "[dependencies]\nelbowroom-cell.workspace = true",
            "[dev-dependencies]\nelbowroom-cell.workspace = true",
            "[build-dependencies]\nelbowroom-cell.workspace = true",
            "[target.'cfg(unix)'.dependencies]\nelbowroom-cell.workspace = true",
            "[dependencies]\nother = { package = \"elbowroom-cell\", path = \"../cell\" }",
        ];
        for table in tables {
            let found = check([manifest("scene", table)]);
            assert_eq!(found, ["scene depends on cell, which is not a lower layer"], "{table}");
        }
    }

    #[test]
    fn the_facade_is_for_the_command_only() {
        assert_eq!(check([manifest("cli", "[dependencies]\nelbowroom.workspace = true")]), Vec::<String>::new());
        assert_eq!(check([manifest("cell", "[dependencies]\nelbowroom.workspace = true")]).len(), 1);
    }

    #[test]
    fn monitor_never_reaches_avoidance_through_others() {
        let crates = [
            manifest("monitor", "[dependencies]\nelbowroom-scene.workspace = true"),
            manifest("scene", "[dependencies]\nelbowroom-avoidance.workspace = true"),
        ];
        let found = check(crates);
        assert!(found.iter().any(|line| line.starts_with("monitor must not depend on avoidance")), "{found:?}");
    }

    #[test]
    fn monitor_never_links_the_scene_checker() {
        let found =
            check([manifest("monitor", "[dependencies]\nelbowroom-scene.workspace = true"), manifest("scene", "")]);
        assert!(found.iter().any(|line| line.starts_with("monitor must not depend on scene")), "{found:?}");
    }

    #[test]
    fn unknown_crates_wrong_names_and_missing_lints_are_found() {
        assert!(check([manifest("unknown", "")])[0].contains("add it there"));
        let renamed = ("scene".to_owned(), manifest("scenery", "").1);
        assert!(check([renamed])[0].contains("not `elbowroom-scene`"));
        let bare = ("scene".to_owned(), "[package]\nname = \"elbowroom-scene\"".parse().unwrap());
        assert!(check([bare])[0].contains("[lints]"));
    }

    #[test]
    fn a_crate_that_may_use_unsafe_code_must_deny_it() {
        let with = |lints: &str| {
            ("capi".to_owned(), format!("[package]\nname = \"elbowroom-capi\"\n{lints}").parse().unwrap())
        };
        assert_eq!(check([with("[lints.rust]\nunsafe_code = \"deny\"")]), Vec::<String>::new());
        assert!(check([with("[lints.rust]\nunsafe_code = \"allow\"")])[0].contains("must say"));
        assert!(check([with("")])[0].contains("must say"));
    }

    #[test]
    fn unsafe_code_must_be_forbidden_for_all() {
        let lax: Table = "[workspace.lints.rust]\nunsafe_code = \"warn\"".parse().unwrap();
        assert_eq!(problems(&lax, &BTreeMap::new()).len(), 1);
    }
}
