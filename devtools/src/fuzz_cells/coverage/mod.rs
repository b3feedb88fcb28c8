//! Which keys of a cell file random cells have, and which tables together: a promise holds only where it was tried.

mod places;

use std::collections::{BTreeMap, BTreeSet};

use elbowroom_cell::key_reference;
use toml::{Table, Value};

use places::{PLACES, UNTRIED};

/// A key: the title of the list that it is in, and its name.
type Key = (&'static str, String);

/// The keys of one cell file.
#[derive(Debug, Default)]
pub struct CellKeys {
    keys: BTreeSet<Key>,
    tables: BTreeSet<String>,
}

/// The keys of many cell files.
#[derive(Debug, Default)]
pub struct Coverage {
    files: usize,
    /// Number of files that have each key.
    keys: BTreeMap<Key, usize>,
    /// Number of files that have two tables.
    pairs: BTreeMap<(String, String), usize>,
}

impl CellKeys {
    /// The keys of a cell file; a text that is none has no keys.
    pub fn of(text: &str) -> Self {
        let Ok(table) = text.parse::<Table>() else { return Self::default() };
        let mut paths = BTreeSet::new();
        walk(&table, "", &mut paths);
        let is_there = |(title, name): &Key| {
            let places = PLACES.iter().filter(|(of, _)| of == title).flat_map(|(_, places)| *places);
            places.map(|place| joined(place, name)).any(|path| paths.contains(&path))
        };
        let tables = table.iter().filter(|(_, value)| value.is_table()).map(|(name, _)| name.clone());
        Self { keys: known_keys().into_iter().filter(is_there).collect(), tables: tables.collect() }
    }
}

impl Coverage {
    /// Counts the keys of a file.
    pub fn add(&mut self, file: &CellKeys) {
        self.files += 1;
        for key in &file.keys {
            *self.keys.entry(key.clone()).or_default() += 1;
        }
        for (index, a) in file.tables.iter().enumerate() {
            for b in file.tables.iter().skip(index + 1) {
                *self.pairs.entry((a.clone(), b.clone())).or_default() += 1;
            }
        }
    }

    /// Counts the keys of other files too.
    pub fn merge(&mut self, other: &Self) {
        self.files += other.files;
        for (key, count) in &other.keys {
            *self.keys.entry(key.clone()).or_default() += count;
        }
        for (pair, count) in &other.pairs {
            *self.pairs.entry(pair.clone()).or_default() += count;
        }
    }

    /// Checks that every key was tried that is not in the list of those that are not, and none of these.
    ///
    /// # Errors
    /// The keys, and what to do.
    pub fn check(&self) -> Result<(), String> {
        let missing: BTreeSet<Key> = known_keys().into_iter().filter(|key| !self.keys.contains_key(key)).collect();
        let untried = untried();
        let list = |keys: Vec<&Key>| -> Vec<String> {
            keys.iter().map(|(title, name)| format!("\n  {title}: {name}")).collect()
        };
        let (new, tried) = (list(missing.difference(&untried).collect()), list(untried.difference(&missing).collect()));
        match (new.is_empty(), tried.is_empty()) {
            (true, true) => Ok(()),
            (false, _) => {
                Err(format!("no random cell has these keys: generate them, and teach the oracle{}", new.concat()))
            }
            (true, false) => Err(format!("random cells have these keys: take them out of UNTRIED{}", tried.concat())),
        }
    }

    /// Prints how many files have each key, and each pair of tables.
    pub fn print(&self) {
        println!("{} cells", self.files);
        for key in known_keys() {
            let count = self.keys.get(&key).copied().unwrap_or(0);
            println!("{count:6}  {}: {}", key.0, key.1);
        }
        for ((a, b), count) in &self.pairs {
            println!("{count:6}  [{a}] with [{b}]");
        }
    }
}

/// The keys of `UNTRIED`.
fn untried() -> BTreeSet<Key> {
    UNTRIED.iter().flat_map(|(title, _, names)| names.iter().map(|name| (*title, (*name).to_owned()))).collect()
}

fn joined(place: &str, name: &str) -> String {
    if place.is_empty() { name.to_owned() } else { format!("{place}.{name}") }
}

/// The keys that the readers accept.
fn known_keys() -> Vec<Key> {
    let of = |(title, table): (&'static str, String)| {
        let names: Vec<String> = table.lines().filter_map(first_code).collect();
        names.into_iter().map(move |name| (title, name))
    };
    key_reference().into_iter().flat_map(of).collect()
}

/// The name in the first column of a row of Markdown.
fn first_code(row: &str) -> Option<String> {
    row.strip_prefix("| `")?.split('`').next().map(str::to_owned)
}

/// Adds the paths of all keys. Names that the writer of the file chooses are `*`; rows of a list are at the path of the list.
fn walk(table: &Table, at: &str, paths: &mut BTreeSet<String>) {
    let are_chosen = has_chosen_names(at);
    for (name, value) in table {
        let path = joined(at, if are_chosen { "*" } else { name });
        if let ("shape", Value::String(word)) = (name.as_str(), value) {
            paths.insert(joined(&path, word));
        }
        inside(value, &path, paths);
        paths.insert(path);
    }
}

fn inside(value: &Value, path: &str, paths: &mut BTreeSet<String>) {
    match value {
        Value::Table(table) => walk(table, path, paths),
        Value::Array(values) => values.iter().for_each(|value| inside(value, path, paths)),
        _ => {}
    }
}

/// Whether the keys of a table are names that the writer of the file chooses.
fn has_chosen_names(at: &str) -> bool {
    let mut places = PLACES.iter().flat_map(|(_, places)| *places);
    places.any(|place| match place.strip_prefix(at).and_then(|rest| rest.strip_prefix(".*")) {
        Some(rest) => !at.is_empty() && (rest.is_empty() || rest.starts_with('.')),
        None => false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_list_of_keys_has_a_place() {
        let titles: BTreeSet<&str> = key_reference().into_iter().map(|(title, _)| title).collect();
        let placed: BTreeSet<&str> = PLACES.iter().map(|(title, _)| *title).collect();
        assert_eq!(titles, placed);
    }

    #[test]
    fn what_is_not_tried_is_a_key_and_has_a_reason() {
        let known: BTreeSet<Key> = known_keys().into_iter().collect();
        let unknown: Vec<Key> = untried().into_iter().filter(|key| !known.contains(key)).collect();
        assert!(unknown.is_empty(), "{unknown:?}");
        assert!(UNTRIED.iter().all(|(_, reason, _)| reason.len() > 10));
    }

    #[test]
    fn keys_are_found_where_they_are() {
        let text = "
            version = 1
            [robot.arm]
            dh = [{ a = 1 }, { kind = \"prismatic\", min = 0 }]
            [robot.arm.tools.gripper]
            tcp = { at = [0, 0, 0] }
            [region.zone]
            shape = \"box\"
            follow = { robot = \"arm\", frame = \"flange\" }
            [program.arm]
            steps = [{ move = \"planned\", to = { at = [0, 0, 1] } }]";
        let found = CellKeys::of(text);
        let has = |title: &'static str, name: &str| found.keys.contains(&(title, name.to_owned()));
        assert!(has("keys of the file", "version") && has("keys of the file", "robot"));
        assert!(has("keys of a row of `dh`", "a") && has("keys of a row of `dh`", "kind"));
        assert!(
            has("keys of [robot.NAME.tool]", "tcp") && has("keys of a pose", "at") && has("shapes of regions", "box")
        );
        assert!(has("keys of `follow` of a region", "frame") && has("keys of a step", "to"));
        assert!(
            !has("keys of [robot.NAME]", "kind")
                && !has("keys of [object.NAME]", "shape")
                && !has("keys of a pose", "rpy")
        );
        let mut coverage = Coverage::default();
        coverage.add(&found);
        coverage.merge(&Coverage::default());
        assert_eq!(coverage.pairs[&("region".to_owned(), "robot".to_owned())], 1);
        assert!(coverage.check().unwrap_err().contains("keys of [grid.NAME]: cells"));
    }
}
