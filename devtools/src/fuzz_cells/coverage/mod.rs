//! Which keys of a cell file random cells have, and which tables together: a promise holds only where it was tried.

mod named_pairs;
mod places;
mod table;

use std::collections::{BTreeMap, BTreeSet};

use elbowroom_cell::key_reference;
use toml::{Table, Value};

use named_pairs::{Feature, NAMED_PAIRS};
use places::PLACES;

/// A key: the title of the list that it is in, and its name.
type Key = (&'static str, String);

/// The keys of one cell file.
#[derive(Debug, Default)]
pub struct CellKeys {
    /// Indices in the list of known keys.
    keys: BTreeSet<usize>,
    features: BTreeSet<Feature>,
}

/// The keys of many cell files.
#[derive(Debug, Default)]
pub struct Coverage {
    files: usize,
    /// Number of files that have two keys, by their indices in the list of known keys, the lower one first; those that have
    /// one key are at its index twice.
    pairs: BTreeMap<(usize, usize), usize>,
    /// Number of files that have two features, by their indices in the list of named pairs.
    named: BTreeMap<usize, usize>,
}

impl CellKeys {
    /// The keys of a cell file; a text that is none has no keys.
    pub fn of(text: &str) -> Self {
        let Ok(table) = text.parse::<Table>() else { return Self::default() };
        let mut paths = BTreeSet::new();
        walk(&table, "", &mut paths);
        let is_there = |(_, (title, name)): &(usize, Key)| {
            let places = PLACES.iter().filter(|(of, _)| of == title).flat_map(|(_, places)| *places);
            places.map(|place| joined(place, name)).any(|path| paths.contains(&path))
        };
        let keys = known_keys().into_iter().enumerate().filter(is_there).map(|(index, _)| index);
        Self { keys: keys.collect(), features: named_pairs::features(text, &table, &paths) }
    }
}

impl Coverage {
    /// Counts the keys of a file.
    pub fn add(&mut self, file: &CellKeys) {
        self.files += 1;
        for a in &file.keys {
            for b in file.keys.range(a..) {
                *self.pairs.entry((*a, *b)).or_default() += 1;
            }
        }
        for (index, [a, b]) in NAMED_PAIRS.iter().enumerate() {
            if file.features.contains(a) && file.features.contains(b) {
                *self.named.entry(index).or_default() += 1;
            }
        }
    }

    /// Counts the keys of other files too.
    pub fn merge(&mut self, other: &Self) {
        self.files += other.files;
        for (pair, count) in &other.pairs {
            *self.pairs.entry(*pair).or_default() += count;
        }
        for (pair, count) in &other.named {
            *self.named.entry(*pair).or_default() += count;
        }
    }

    /// Number of files that have a key, by its index.
    fn with(&self, key: usize) -> usize {
        self.pairs.get(&(key, key)).copied().unwrap_or(0)
    }

    /// Checks that every key was tried, and that the named pairs of features were tried together.
    ///
    /// # Errors
    /// The keys, and what to do.
    pub fn check(&self) -> Result<(), String> {
        let all = known_keys().into_iter().enumerate();
        let missing = all.filter(|(index, _)| self.with(*index) == 0);
        let missing: Vec<String> = missing.map(|(_, (title, name))| format!("\n  {title}: {name}")).collect();
        if missing.is_empty() {
            return self.check_named_pairs();
        }
        Err(format!("no random cell has these keys: generate them, and teach the oracle{}", missing.concat()))
    }

    fn check_named_pairs(&self) -> Result<(), String> {
        let is_missing = |(index, _): &(usize, &[Feature; 2])| !self.named.contains_key(index);
        let missing = NAMED_PAIRS.iter().enumerate().filter(is_missing);
        let missing: Vec<String> = missing.map(|(_, [a, b])| format!("\n  {a:?} with {b:?}")).collect();
        if missing.is_empty() {
            return Ok(());
        }
        Err(format!("no random cell has these features together: generate them{}", missing.concat()))
    }

    /// Prints how many files have each key, and the named pairs of features.
    pub fn print(&self) {
        println!("{} cells", self.files);
        for (index, (title, name)) in known_keys().into_iter().enumerate() {
            println!("{:6}  {title}: {name}", self.with(index));
        }
        for (index, [a, b]) in NAMED_PAIRS.iter().enumerate() {
            println!("{:6}  {a:?} with {b:?}", self.named.get(&index).copied().unwrap_or(0));
        }
    }
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
        let all = known_keys();
        let has = |title: &str, name: &str| found.keys.iter().any(|key| (all[*key].0, &*all[*key].1) == (title, name));
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
        assert_eq!(
            found.features,
            BTreeSet::from([
                Feature::Tool,
                Feature::Region,
                Feature::MovingRegion,
                Feature::Carrier,
                Feature::PlannedMove
            ])
        );
        let mut coverage = Coverage::default();
        coverage.add(&found);
        coverage.merge(&Coverage::default());
        let [version, robot] = ["version", "robot"].map(|name| all.iter().position(|key| key.1 == name).unwrap());
        assert_eq!(coverage.pairs[&(version.min(robot), version.max(robot))], 1);
        assert_eq!(coverage.named.len(), 1);
        assert!(coverage.check().unwrap_err().contains("keys of [grid.NAME]: cells"));
    }
}
