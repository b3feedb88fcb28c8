//! Who may depend on whom. The order of [`ROOMS`] is the architecture; `docs/architecture.md` explains it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use toml::{Table, Value};

/// Ground floor first: a crate may use only what stands above it. Some rooms are planned and not built yet.
const ROOMS: [&str; 16] = [
    "spatial",
    "lanes",
    "proximity",
    "kinematics",
    "scene",
    "formats",
    "monitor",
    "cspace",
    "planner",
    "avoidance",
    "vision",
    "cell",
    "live",
    "elbowroom",
    "cli",
    "python",
];

/// Rooms that may opt out of `forbid(unsafe_code)`: SIMD, and the glue that Python needs.
const MAY_USE_UNSAFE: [&str; 2] = ["lanes", "python"];

/// Never, not even through others: (who, on whom, why).
const NEVER: [(&str, &str, &str); 1] =
    [("monitor", "avoidance", "avoidance proposes a motion, the monitor scales it last")];

/// Checks the workspace at `root` and prints the result.
pub fn run(root: &Path) -> Result<(), String> {
    let workspace = parse(&root.join("Cargo.toml"))?;
    let mut manifests = BTreeMap::new();
    let entries = std::fs::read_dir(root.join("crates")).map_err(|e| format!("crates: {e}"))?;
    for entry in entries {
        let path = entry.map_err(|e| format!("crates: {e}"))?.path();
        let manifest = path.join("Cargo.toml");
        if manifest.is_file() {
            let room = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            manifests.insert(room, parse(&manifest)?);
        }
    }
    let problems = problems(&workspace, &manifests);
    if problems.is_empty() {
        println!("layers: {} rooms, every dependency points to a room above it", manifests.len());
        return Ok(());
    }
    Err(format!("the layers are broken\n  {}", problems.join("\n  ")))
}

fn parse(path: &Path) -> Result<Table, String> {
    let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
    text.parse().map_err(|e| format!("{}: {e}", path.display()))
}

/// Everything wrong with these manifests (room name → its `Cargo.toml`), in a fixed order.
fn problems(workspace: &Table, manifests: &BTreeMap<String, Table>) -> Vec<String> {
    let mut found = Vec::new();
    if lookup(workspace, &["workspace", "lints", "rust", "unsafe_code"]).and_then(Value::as_str) != Some("forbid") {
        found.push("Cargo.toml: [workspace.lints.rust] must say unsafe_code = \"forbid\"".into());
    }
    let uses: BTreeMap<&str, BTreeSet<String>> =
        manifests.iter().map(|(room, manifest)| (room.as_str(), rooms_used(manifest))).collect();
    for (room, manifest) in manifests {
        found.extend(name_problems(room, manifest));
        found.extend(lint_problem(room, manifest));
        found.extend(order_problems(room, &uses[room.as_str()]));
    }
    for (who, whom, why) in NEVER {
        if reaches(&uses, who, whom, &mut BTreeSet::new()) {
            found.push(format!("{who} must not depend on {whom}, directly or through others: {why}"));
        }
    }
    found
}

fn name_problems(room: &str, manifest: &Table) -> Option<String> {
    let name = lookup(manifest, &["package", "name"]).and_then(Value::as_str).unwrap_or_default();
    let expected = if room == "elbowroom" { room.to_owned() } else { format!("elbowroom-{room}") };
    (name != expected).then(|| format!("crates/{room}/Cargo.toml: the package is called `{name}`, not `{expected}`"))
}

fn lint_problem(room: &str, manifest: &Table) -> Option<String> {
    if MAY_USE_UNSAFE.contains(&room) {
        return None;
    }
    let opted_in = lookup(manifest, &["lints", "workspace"]).and_then(Value::as_bool) == Some(true);
    (!opted_in)
        .then(|| format!("crates/{room}/Cargo.toml: add `[lints]` with `workspace = true` (it forbids unsafe code)"))
}

fn order_problems(room: &str, uses: &BTreeSet<String>) -> Vec<String> {
    let Some(floor) = floor_of(room) else {
        return vec![format!(
            "crates/{room} is not in ROOMS of xtask/src/layers.rs: add it there, at its floor, and to docs/architecture.md"
        )];
    };
    let too_high = uses.iter().filter(|used| floor_of(used).is_none_or(|other| other >= floor));
    too_high
        .map(|used| format!("{room} depends on {used}, which does not stand above it in the list of rooms"))
        .collect()
}

fn floor_of(room: &str) -> Option<usize> {
    ROOMS.iter().position(|&name| name == room)
}

fn reaches(uses: &BTreeMap<&str, BTreeSet<String>>, from: &str, to: &str, seen: &mut BTreeSet<String>) -> bool {
    let Some(used) = uses.get(from) else { return false };
    used.iter().any(|next| next == to || (seen.insert(next.clone()) && reaches(uses, next, to, seen)))
}

/// Rooms named by any dependency table, those of tests, build scripts and single targets included.
fn rooms_used(manifest: &Table) -> BTreeSet<String> {
    let mut tables = vec![manifest];
    if let Some(targets) = manifest.get("target").and_then(Value::as_table) {
        tables.extend(targets.values().filter_map(Value::as_table));
    }
    let kinds = ["dependencies", "dev-dependencies", "build-dependencies"];
    let sections = tables.iter().flat_map(|table| kinds.iter().filter_map(|kind| table.get(*kind)?.as_table()));
    sections.flatten().filter_map(|(key, value)| room_of_dependency(key, value)).collect()
}

fn room_of_dependency(key: &str, value: &Value) -> Option<String> {
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

    fn manifest(room: &str, rest: &str) -> (String, Table) {
        let text = format!("[package]\nname = \"elbowroom-{room}\"\n[lints]\nworkspace = true\n{rest}");
        (room.to_owned(), text.parse().unwrap())
    }

    fn check(manifests: impl IntoIterator<Item = (String, Table)>) -> Vec<String> {
        problems(&workspace(), &manifests.into_iter().collect())
    }

    #[test]
    fn a_sound_house_passes() {
        let rooms = [
            manifest("spatial", "[dependencies]\nglam = \"1\""),
            manifest("monitor", "[dependencies]\nelbowroom-spatial.workspace = true"),
            manifest("cell", "[dev-dependencies]\nelbowroom-monitor = { path = \"../monitor\" }"),
        ];
        assert_eq!(check(rooms), Vec::<String>::new());
    }

    #[test]
    fn a_dependency_on_a_later_room_is_found_in_every_kind_of_table() {
        let tables = [
            "[dependencies]\nelbowroom-cell.workspace = true",
            "[dev-dependencies]\nelbowroom-cell.workspace = true",
            "[build-dependencies]\nelbowroom-cell.workspace = true",
            "[target.'cfg(unix)'.dependencies]\nelbowroom-cell.workspace = true",
            "[dependencies]\nother = { package = \"elbowroom-cell\", path = \"../cell\" }",
        ];
        for table in tables {
            let found = check([manifest("scene", table)]);
            assert_eq!(found, ["scene depends on cell, which does not stand above it in the list of rooms"], "{table}");
        }
    }

    #[test]
    fn the_facade_stands_below_the_command_only() {
        assert_eq!(check([manifest("cli", "[dependencies]\nelbowroom.workspace = true")]), Vec::<String>::new());
        assert_eq!(check([manifest("cell", "[dependencies]\nelbowroom.workspace = true")]).len(), 1);
    }

    #[test]
    fn monitor_never_reaches_avoidance_through_others() {
        let rooms = [
            manifest("monitor", "[dependencies]\nelbowroom-scene.workspace = true"),
            manifest("scene", "[dependencies]\nelbowroom-avoidance.workspace = true"),
        ];
        let found = check(rooms);
        assert!(found.iter().any(|line| line.starts_with("monitor must not depend on avoidance")), "{found:?}");
    }

    #[test]
    fn unknown_rooms_wrong_names_and_missing_lints_are_found() {
        assert!(check([manifest("attic", "")])[0].contains("add it there"));
        let renamed = ("scene".to_owned(), manifest("scenery", "").1);
        assert!(check([renamed])[0].contains("not `elbowroom-scene`"));
        let bare = ("scene".to_owned(), "[package]\nname = \"elbowroom-scene\"".parse().unwrap());
        assert!(check([bare])[0].contains("[lints]"));
    }

    #[test]
    fn unsafe_code_must_be_forbidden_for_all() {
        let lax: Table = "[workspace.lints.rust]\nunsafe_code = \"warn\"".parse().unwrap();
        assert_eq!(problems(&lax, &BTreeMap::new()).len(), 1);
    }
}
