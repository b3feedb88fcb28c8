//! Contents of a seal: every key of the cell file that affects the monitors, as text.

use std::collections::BTreeMap;

use elbowroom_access::{Change, hex, trust};
use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{Data, Entry, Node};
use elbowroom_monitor::{AccessClass, Life};

use super::source::SealedSource;
use super::value::{key, text};
use crate::file::REGION_TABLES;
use crate::{Cell, CellFile, configure};

/// Tables and keys that do not affect the monitors. Everything else is sealed. An object that a region follows is
/// sealed with the region.
const FREE: &[&str] =
    &["version", "name", "max_s", "checksum", "object", "scene", "map", "pairs", "avoidance", "program"];
/// Tables with names: `[robot.NAME]`.
const NAMED: &[&str] = &["robot", "region", "encoder", "fence"];
/// Initial joint values of a robot in the simulation.
const START: &str = "start";

/// Values by table and key.
#[derive(Debug, Clone, Default)]
pub(super) struct SealedState {
    values: BTreeMap<(String, String), String>,
    /// Line of each value; empty in a state read from a log.
    lines: BTreeMap<(String, String), usize>,
}

impl SealedState {
    /// The state of a cell file and the files it names.
    pub fn of(file: &CellFile, cell: &Cell) -> Result<Self, Diagnostic> {
        let mut state = Self::default();
        for e in file.entries.iter().filter(|e| !FREE.contains(&e.key.as_str())) {
            match &e.node.data {
                Data::Table(entries) if NAMED.contains(&e.key.as_str()) => {
                    for named in entries {
                        state.add_item(&format!("{}.{}", item_word(&e.key), named.key), named);
                    }
                }
                Data::Table(_) => state.add_item(&e.key, e),
                _ => state.add("cell", &e.key, &e.node),
            }
        }
        for (robot, setup) in cell.robots.iter().zip(configure::setups(cell)?) {
            state.resolved(format!("robot.{}", robot.name), Some(robot.line), setup.configuration.robot_checksum());
        }
        for r in &cell.regions {
            let item = format!("region.{}", r.region.name);
            state.resolved(item.clone(), Some(r.line), r.region.checksum());
            if let Some(source) = SealedSource::of(file, cell, r) {
                state.add_source(&item, r.line, &source);
            }
        }
        for (id, key) in trust::beside(&file.file)? {
            state.values.insert((trust::FILE.into(), id), key);
        }
        Ok(state)
    }

    fn resolved(&mut self, item: String, line: Option<usize>, checksum: String) {
        let at = (item, Change::RESOLVED.to_owned());
        line.map(|line| self.lines.insert(at.clone(), line));
        self.values.insert(at, checksum);
    }

    /// Adds the source of a region as a part of the region, so that the same class may change both.
    fn add_source(&mut self, region: &str, line: usize, source: &SealedSource<'_>) {
        if let Some(object) = source.object {
            self.add(region, &format!("{}{}", Change::OBJECT, key(&object.key)), &object.node);
        }
        let at = (region.to_owned(), format!("{}{}", Change::FOLLOWS, source.title()));
        self.lines.insert(at.clone(), source.files.first().map_or(line, |f| f.line));
        self.values.insert(at, source.checksum.clone());
    }

    fn add_item(&mut self, item: &str, entry: &Entry) {
        match &entry.node.data {
            Data::Table(entries) => {
                let robot = item.starts_with("robot.");
                entries
                    .iter()
                    .filter(|e| !(robot && e.key == START))
                    .for_each(|e| self.add(item, &key(&e.key), &e.node));
            }
            _ => self.add(item, "", &entry.node),
        }
    }

    /// Adds a value. A nested table adds one value per key.
    fn add(&mut self, item: &str, field: &str, node: &Node) {
        match &node.data {
            Data::Table(entries) if !entries.is_empty() => {
                for e in entries {
                    self.add(item, &format!("{field}.{}", key(&e.key)), &e.node);
                }
            }
            _ => {
                let at = (item.to_owned(), field.to_owned());
                self.lines.insert(at.clone(), node.line);
                self.values.insert(at, text(node));
            }
        }
    }

    /// The line of a change in the cell file; for a removed key, the line of its table.
    pub fn line(&self, change: &Change) -> Option<usize> {
        let at = |field: &str| self.lines.get(&(change.item.clone(), field.to_owned())).copied();
        at(&change.field).or_else(|| at(Change::RESOLVED))
    }

    /// All differences.
    pub fn changes_to(&self, after: &Self) -> Vec<Change> {
        let mut all: Vec<_> = self.values.keys().chain(after.values.keys()).collect();
        all.sort_unstable();
        all.dedup();
        let change = |at: &(String, String)| Change {
            item: at.0.clone(),
            field: at.1.clone(),
            before: self.values.get(at).cloned(),
            after: after.values.get(at).cloned(),
        };
        all.into_iter().filter(|at| self.values.get(at) != after.values.get(at)).map(change).collect()
    }

    /// This state with the changes applied; `None` if they do not fit.
    pub fn with(&self, changes: &[Change]) -> Option<Self> {
        let mut state = Self { values: self.values.clone(), lines: BTreeMap::new() };
        for c in changes {
            let at = (c.item.clone(), c.field.clone());
            let before = match &c.after {
                Some(after) => state.values.insert(at, after.clone()),
                None => state.values.remove(&at),
            };
            if before != c.before || c.before == c.after {
                return None;
            }
        }
        Some(state)
    }

    /// SHA-256 over everything; each text is preceded by its length.
    pub fn digest(&self) -> String {
        let mut bytes = Vec::new();
        for ((item, field), value) in &self.values {
            for text in [item, field, value] {
                bytes.extend((text.len() as u64).to_le_bytes());
                bytes.extend(text.as_bytes());
            }
        }
        hex::hash(&bytes)
    }

    /// The sealed entry of a key beside the cell.
    pub fn sealed_key(&self, id: &str) -> Option<&str> {
        self.values.get(&(trust::FILE.to_owned(), id.to_owned())).map(String::as_str)
    }

    /// The life of a region; `None` for an unknown region.
    fn life(&self, item: &str) -> Option<Life> {
        let value = |field: &str| self.values.get(&(item.to_owned(), field.to_owned()));
        value(Change::RESOLVED)?;
        Some(if value("life").is_some_and(|l| l == "\"temporary\"") { Life::Temporary } else { Life::Permanent })
    }
}

/// How an item of a table is called: a fence is a region, and their names differ.
fn item_word(table: &str) -> &str {
    if REGION_TABLES.contains(&table) { "region" } else { table }
}

/// The lowest class that may make these changes: the programmer if all of them concern regions that are temporary
/// before and after.
pub(super) fn least_class(before: &SealedState, after: &SealedState, changes: &[Change]) -> AccessClass {
    let of = |change: &Change| {
        if !change.item.starts_with("region.") {
            return AccessClass::Integrator;
        }
        let lives = [before.life(&change.item), after.life(&change.item)];
        lives.into_iter().flatten().map(Life::needed_class).max().unwrap_or(AccessClass::Integrator)
    };
    changes.iter().map(of).max().unwrap_or(AccessClass::Programmer)
}

/// The changes without derived changes of checksums.
pub(super) fn without_consequences(changes: &[Change]) -> Vec<&Change> {
    let made = |c: &&Change| c.is_written();
    // Units and laws affect everything.
    let everywhere = changes.iter().filter(made).any(|c| !NAMED.iter().any(|n| c.item.starts_with(&format!("{n}."))));
    let whole = |c: &Change| c.before.is_none() || c.after.is_none();
    let is_new_or_removed =
        |item: &str| changes.iter().any(|c| c.item == item && c.field == Change::RESOLVED && whole(c));
    let shown = |c: &&Change| {
        if is_new_or_removed(&c.item) {
            return c.field == Change::RESOLVED;
        }
        let covers = |other: &Change| other.item == c.item && other.is_of_source() == c.is_of_source();
        c.is_written() || !(everywhere || changes.iter().filter(made).any(covers))
    };
    changes.iter().filter(shown).collect()
}
