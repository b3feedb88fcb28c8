//! Edits of regions while a cell runs, applied to its file in memory.

use std::collections::BTreeMap;
use std::path::{Component, Path};

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{self, Data, Entry, Node};
use elbowroom_monitor::{Life, RegionKind};
use serde::{Deserialize, Serialize};

use crate::file::{REGION_TABLES, with_only_region};
use crate::seal::value::{key, text};
use crate::{Cell, CellFile, CellRegion, Follow, configure};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Keys for the place of a region; all other keys define what it is.
const PLACE: [&str; 11] = ["centre", "center", "base", "at", "origin", "x", "y", "from", "to", "rpy", "quaternion"];
/// The keys, at any depth, whose values are paths of files.
const FILES: [&str; 3] = ["mesh", "poses", "file"];

/// A region that differs from the cell file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RegionEdit {
    /// Its name.
    pub name: String,
    /// Its keys as TOML, one per line; `None` if it is removed.
    pub table: Option<String>,
}

/// The file of a running cell, in which regions are added and removed in memory.
///
/// The file on disk stays unchanged.
///
/// ```
/// use elbowroom_cell::{EditedRegions, RegionEdit};
/// let file = EditedRegions::parse("rail.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.rail]
/// dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
/// "#)?;
/// let table =
///     file.table_of("cart", "shape = \"sphere\"\ncentre = [0, 0, 2500]\nradius = 100\nwarning = 100\nguards = [\"tcp\"]")?;
/// let moved = file.moved("cart", &table, "centre = [0, 0, 2900]")?;
/// let cell = file.cell(&[RegionEdit { name: "cart".into(), table: Some(moved) }])?;
/// assert_eq!(cell.regions[0].region.anchor.translation.z, 2.9);
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
#[derive(Debug, Clone)]
pub struct EditedRegions {
    file: CellFile,
}

impl EditedRegions {
    /// Reads the file of a cell.
    ///
    /// # Errors
    /// [`Diagnostic`] if it cannot be read.
    pub fn read(cell: &Cell) -> Result<Self> {
        Ok(Self { file: CellFile::read(&cell.file)?.unsealed() })
    }

    /// Parses text as the file `path`.
    ///
    /// # Errors
    /// [`Diagnostic`] if it is not TOML.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self> {
        Ok(Self { file: CellFile::parse(path, text)? })
    }

    /// The cell with these edits of its regions.
    ///
    /// # Errors
    /// [`Diagnostic`] as for a cell file; lines are counted in the region's own keys.
    pub fn cell(&self, edits: &[RegionEdit]) -> Result<Cell> {
        let mut file = self.file.clone();
        // The checksum is valid for the file without edits.
        file.entries.retain(|e| e.key != "checksum");
        for edit in edits {
            let keys = edit.table.as_ref().map(|table| toml_tables::parse(&file.file, table)).transpose()?;
            let regions = regions(&mut file.entries);
            let at = regions.iter().position(|e| e.key == edit.name);
            let entry = keys.map(|keys| Entry {
                key: edit.name.clone(),
                line: 1,
                node: Node { line: 1, data: Data::Table(keys) },
            });
            match (at, entry) {
                (Some(at), Some(entry)) => regions[at] = entry,
                (None, Some(entry)) => regions.push(entry),
                (Some(at), None) => drop(regions.remove(at)),
                (None, None) => {}
            }
        }
        file.resolve()
    }

    /// The present keys of a region, one per line; `None` if the cell has no region of this name.
    pub fn table(&self, edits: &[RegionEdit], name: &str) -> Option<String> {
        if let Some(edit) = edits.iter().find(|e| e.name == name) {
            return edit.table.clone();
        }
        let all = self.file.entries.iter().find(|e| e.key == "region")?;
        let found = keys_of(all).iter().find(|e| e.key == name)?;
        Some(lines(keys_of(found)))
    }

    /// Returns the edits with one more, which replaces an edit of the same region.
    ///
    /// The removal of a region that the file does not have is omitted.
    #[must_use]
    pub fn with(&self, edits: &[RegionEdit], edit: RegionEdit) -> Vec<RegionEdit> {
        let mut all: Vec<RegionEdit> = edits.iter().filter(|e| e.name != edit.name).cloned().collect();
        if edit.table.is_some() || self.table(&[], &edit.name).is_some() {
            all.push(edit);
        }
        all
    }

    /// Parses the keys of a new region: the keys of `[region.NAME]`, or that table itself.
    ///
    /// # Errors
    /// [`Diagnostic`] if it is not TOML, another region's table, or names a file outside of the cell's folder.
    pub fn table_of(&self, name: &str, toml: &str) -> Result<String> {
        let path = &self.file.file;
        let (is_fence, entries) = keys_of_region(path, name, toml)?;
        if is_fence {
            let what =
                format!("`fence` is not the table of the region `{name}`: fences are not added while the cell runs");
            let help = format!("[region.{name}] and its keys; or the fence in the cell file");
            return Err(Diagnostic::new(path, None, what).hint(help));
        }
        // A table within would be written as a line of its own all the same.
        Ok(lines(&entries))
    }

    /// The keys of a region after a move.
    ///
    /// # Errors
    /// [`Diagnostic`] if `to` is empty, is not TOML, or has a key that does not define a place.
    pub fn moved(&self, name: &str, table: &str, to: &str) -> Result<String> {
        let path = &self.file.file;
        let mut keys = toml_tables::parse(path, table)?;
        let place = toml_tables::parse(path, to)?;
        if place.is_empty() {
            let what = format!("it is not said where region `{name}` is moved");
            return Err(Diagnostic::new(path, None, what).hint(hint_for(&keys)));
        }
        for entry in place {
            if !PLACE.contains(&entry.key.as_str()) {
                let what = format!("`{}` does not say where region `{name}` is", entry.key);
                let help = format!("{}; a region of another shape is removed and added", hint_for(&keys));
                return Err(Diagnostic::new(path, None, what).hint(help));
            }
            match keys.iter_mut().find(|known| known.key == entry.key) {
                Some(known) => *known = entry,
                None => keys.push(entry),
            }
        }
        Ok(lines(&keys))
    }
}

/// A running cell with one region in place of its own: a region that is being taught, or a part of it. The rest of the
/// cell is as it is; only the region is read.
///
/// `toml` has the keys of `[region.NAME]`, that table itself, or the table `[fence.NAME]`.
///
/// ```
/// use elbowroom_cell::{Cell, cell_with_only};
/// let cell = Cell::parse("rail.toml", r#"
/// version = 1
/// units = { length = "mm", angle = "deg" }
/// [robot.rail]
/// dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
/// links = [{ sphere = { radius = 50 } }]
/// [region.table]
/// shape = "sphere"
/// centre = [0, 0, 2500]
/// radius = 100
/// warning = 100
/// "#)?;
/// let fence = "[fence.yard]\ncorners = [[-900, -900], [900, -900], [900, 900]]\nheight = 2000";
/// let alone = cell_with_only(&cell, "yard", fence)?;
/// assert_eq!((alone.regions.len(), alone.regions[0].table().as_str()), (1, "[fence.yard]"));
/// # Ok::<(), elbowroom_formats::Diagnostic>(())
/// ```
///
/// # Errors
/// [`Diagnostic`] as for a cell file; lines are counted in the region's own keys.
pub fn cell_with_only(cell: &Cell, name: &str, toml: &str) -> Result<Cell> {
    let (is_fence, keys) = keys_of_region(&cell.file, name, toml)?;
    with_only_region(cell, name, is_fence, keys)
}

/// The keys of a region that is given by them or by its table, and whether the table is a fence's.
fn keys_of_region(path: &Path, name: &str, toml: &str) -> Result<(bool, Vec<Entry>)> {
    let mut entries = toml_tables::parse(path, toml)?;
    let mut is_fence = false;
    if let [Entry { key: word, node: Node { data: Data::Table(tables), .. }, .. }] = &entries[..]
        && REGION_TABLES.contains(&word.as_str())
    {
        match &tables[..] {
            [Entry { key, node: Node { data: Data::Table(keys), .. }, .. }] if key == name => {
                is_fence = word != REGION_TABLES[0];
                entries = keys.clone();
            }
            _ => {
                let what = format!("`{word}` is not the table of the region `{name}` alone");
                return Err(Diagnostic::new(path, None, what).hint(format!("[{word}.{name}] and its keys")));
            }
        }
    }
    check_files(path, &entries)?;
    Ok((is_fence, entries))
}

/// Hint with the keys that a move of this region may have.
fn hint_for(keys: &[Entry]) -> String {
    let place: Vec<String> = keys
        .iter()
        .filter(|e| PLACE.contains(&e.key.as_str()))
        .map(|e| format!("{} = {}", key(&e.key), text(&e.node)))
        .collect();
    format!("one or more of {}; it is at {}", PLACE.join(", "), place.join(", "))
}

fn regions(entries: &mut Vec<Entry>) -> &mut Vec<Entry> {
    let at = entries.iter().position(|e| e.key == "region").unwrap_or_else(|| {
        entries.push(Entry { key: "region".into(), line: 1, node: Node { line: 1, data: Data::Table(Vec::new()) } });
        entries.len() - 1
    });
    let entry = &mut entries[at];
    if !matches!(entry.node.data, Data::Table(_)) {
        // A valid cell has a table here.
        entry.node.data = Data::Table(Vec::new());
    }
    match &mut entry.node.data {
        Data::Table(regions) => regions,
        _ => unreachable!("it was made a table"),
    }
}

fn keys_of(entry: &Entry) -> &[Entry] {
    if let Data::Table(keys) = &entry.node.data { keys } else { &[] }
}

fn lines(keys: &[Entry]) -> String {
    let lines: Vec<String> = keys.iter().map(|e| format!("{} = {}", key(&e.key), text(&e.node))).collect();
    lines.join("\n") + "\n"
}

/// Refuses files outside of the cell's folder: an edit of a region must not make the service read other files.
fn check_files(path: &Path, entries: &[Entry]) -> Result<()> {
    for entry in entries {
        if let (true, Data::Text(file)) = (FILES.contains(&entry.key.as_str()), &entry.node.data)
            && !Path::new(file).components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir))
        {
            let what = format!("`{}` names a file outside of the cell's folder: {file:?}", entry.key);
            return Err(Diagnostic::new(path, entry.line, what).hint("a file in that folder, or below it"));
        }
        check_files(path, keys_of(entry))?;
    }
    Ok(())
}

/// Differences between two tables of a region: key, value before, value after.
pub fn table_changes(before: Option<&str>, after: Option<&str>) -> Vec<(String, Option<String>, Option<String>)> {
    let keys = |table: Option<&str>| -> BTreeMap<String, String> {
        let entries = table.and_then(|table| toml_tables::parse(Path::new(""), table).ok()).unwrap_or_default();
        entries.iter().map(|e| (key(&e.key), text(&e.node))).collect()
    };
    let (before, after) = (keys(before), keys(after));
    let mut all: Vec<&String> = before.keys().chain(after.keys()).collect();
    all.sort_unstable();
    all.dedup();
    let change = |k: &String| (k.clone(), before.get(k).cloned(), after.get(k).cloned());
    all.into_iter().map(change).filter(|(_, before, after)| before != after).collect()
}

/// Reason why a process that guards the cell file `now` cannot continue with `next`; `None` if it can.
///
/// Robots, laws, exchange regions and permanent regions must stay the same, and no further robot may be followed.
///
/// # Errors
/// [`Diagnostic`] if no monitor accepts a region.
pub fn why_not_continued(now: &Cell, next: &Cell) -> Result<Option<String>> {
    let (before, after) = (configure::setups(now)?, configure::setups(next)?);
    let robots = |setups: &[configure::MonitorSetup]| -> Vec<String> {
        setups.iter().map(|s| s.configuration.robot_checksum()).collect()
    };
    if robots(&before) != robots(&after) || now.monitoring != next.monitoring {
        return Ok(Some(
            "the robots or laws of the cell file, or a file that it names, have changed since the start".into(),
        ));
    }
    let exchange = |cell: &Cell| -> Vec<(String, String)> {
        let of_kind = cell.regions.iter().filter(|r| matches!(r.region.kind, RegionKind::Exchange { .. }));
        of_kind.map(|r| (r.region.name.clone(), r.region.checksum())).collect()
    };
    if exchange(now) != exchange(next) {
        return Ok(Some("exchange regions are not changed while the cell runs".into()));
    }
    if let Some(name) = permanent_that_differs(now, next) {
        return Ok(Some(format!(
            "region `{name}` is permanent and in the cell file: it stays as it is while the cell runs"
        )));
    }
    let followed = |s: &configure::MonitorSetup| -> Vec<usize> {
        let robot = |f: &Follow| if let Follow::Robot { robot, .. } = f { Some(robot.0) } else { None };
        s.sources.iter().filter_map(robot).collect()
    };
    let is_new = |(before, after): (&configure::MonitorSetup, &configure::MonitorSetup)| {
        let known = followed(before);
        followed(after).iter().any(|robot| !known.contains(robot))
    };
    if before.iter().zip(&after).any(is_new) {
        return Ok(Some("the region follows a robot that no region of the cell file follows".into()));
    }
    Ok(None)
}

/// Name of a permanent region of `now` that is missing or different in `next`.
///
/// The seal defines a permanent region; a message cannot change it.
fn permanent_that_differs<'a>(now: &'a Cell, next: &Cell) -> Option<&'a str> {
    let permanent = now.regions.iter().filter(|r| r.region.life == Life::Permanent);
    let is_kept = |r: &&CellRegion| {
        let found = next.regions.iter().find(|n| n.region.name == r.region.name);
        found.is_some_and(|n| {
            let is_same_region = n.region.checksum() == r.region.checksum() && n.robots == r.robots;
            is_same_region && n.follow == r.follow && n.source_limits == r.source_limits
        })
    };
    permanent.filter(|r| !is_kept(r)).map(|r| r.region.name.as_str()).next()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RegionSolid;

    const FILE: &str = r#"
version = 1
units = { length = "mm", angle = "deg" }
[robot.rail]
dh = [{ kind = "prismatic", min = 0, max = 2000, speed = 1000 }]
links = [{ sphere = { radius = 50 } }]
[region.end]
shape = "sphere"
centre = [0, 0, 2500]
radius = 200
warning = 100
life = "temporary"
[region.wall]
shape = "sphere"
centre = [0, 900, 0]
radius = 100
warning = 100
[region.table]
shape = "sphere"
centre = [0, 0, 900]
radius = 200
warning = 100
kind = "exchange"
"#;
    const CART: &str =
        "shape = \"box\"\nbase = [0, 0, 1700]\nsize = [100, 100, 100]\nlife = \"temporary\"\nwarning = 100";

    fn edited() -> EditedRegions {
        EditedRegions::parse("rail.toml", FILE).unwrap()
    }

    fn edit(name: &str, table: Option<&str>) -> RegionEdit {
        RegionEdit { name: name.into(), table: table.map(Into::into) }
    }

    #[test]
    fn regions_are_added_moved_and_removed_in_memory() {
        let file = edited();
        let names = |cell: &Cell| cell.regions.iter().map(|r| r.region.name.clone()).collect::<Vec<_>>();
        let base = file.cell(&[]).unwrap();
        assert_eq!(base.approval.checksum, Cell::parse("rail.toml", FILE).unwrap().approval.checksum);
        let table = file.table_of("cart", CART).unwrap();
        assert_eq!(file.table_of("cart", &format!("[region.cart]\n{CART}")).unwrap(), table);
        let edits = file.with(&[], edit("cart", Some(&table)));
        let added = file.cell(&edits).unwrap();
        assert_eq!(names(&added), ["end", "wall", "table", "cart"]);
        assert_eq!(why_not_continued(&base, &added).unwrap(), None);
        let moved = file.moved("end", &file.table(&edits, "end").unwrap(), "centre = [0, 0, 2600]").unwrap();
        let edits = file.with(&edits, edit("end", Some(&moved)));
        let cell = file.cell(&edits).unwrap();
        assert_eq!(names(&cell), ["end", "wall", "table", "cart"], "each is where it was in the file");
        assert!((cell.regions[0].region.anchor.translation.z - 2.6).abs() < 1e-12);
        let changes = table_changes(file.table(&[], "end").as_deref(), Some(&moved));
        assert_eq!(changes, [("centre".into(), Some("[0, 0, 2500]".into()), Some("[0, 0, 2600]".into()))]);
        // A region that was added and removed again leaves no edit.
        let edits = file.with(&file.with(&edits, edit("cart", None)), edit("end", None));
        assert_eq!(edits, [edit("end", None)]);
        assert_eq!(names(&file.cell(&edits).unwrap()), ["wall", "table"]);
        assert_eq!(file.table(&edits, "end"), None);
    }

    #[test]
    fn errors_are_those_of_a_cell_file_and_name_the_line_of_the_table() {
        let file = edited();
        let error = |toml: &str| {
            let table = file.table_of("cart", toml)?;
            file.cell(&[edit("cart", Some(&table))]).map(drop)
        };
        let cases = [
            ("shape = \"cube\"", "cube"),
            ("shape = \"sphere\"\ncentre = [0, 0, 1]\nradius = -5", "radius"),
            ("shape = \"sphere\"\ncentre = [0, 0, 1]\nradius = 5\n[robot.left]\nbase = 1", "robot"),
            ("[region.other]\nshape = \"sphere\"", "is not the table of the region `cart` alone"),
            ("shape = ", "TOML"),
            ("shape = \"mesh\"\nmesh = \"../../etc/passwd\"\nat = [0, 0, 0]", "outside of the cell's folder"),
            ("shape = \"mesh\"\nmesh = \"/etc/passwd\"\nat = [0, 0, 0]", "outside of the cell's folder"),
            ("shape = \"sphere\"\ncentre = [0, 0, 1]\nradius = 5\nfollow = { poses = \"/etc/passwd\" }", "outside"),
        ];
        for (toml, expected) in cases {
            let error = error(toml).unwrap_err().to_string();
            assert!(error.contains(expected), "{toml}: {error}");
        }
        assert_eq!(error("shape = \"sphere\"\ncentre = [0, 0, 1]\nradius = -5").unwrap_err().line, Some(3));
        let end = file.table(&[], "end").unwrap();
        for (to, expected) in
            [("radius = 5", "does not say where region `end` is"), ("", "where region `end` is moved")]
        {
            assert!(file.moved("end", &end, to).unwrap_err().to_string().contains(expected), "{to}");
        }
    }

    #[test]
    fn a_region_alone_is_the_one_that_the_whole_cell_would_have() {
        let (file, cell) = (edited(), edited().cell(&[]).unwrap());
        for toml in [CART.to_owned(), format!("[region.cart]\n{CART}")] {
            let alone = cell_with_only(&cell, "cart", &toml).unwrap();
            let table = file.table_of("cart", &toml).unwrap();
            let whole = file.cell(&file.with(&[], edit("cart", Some(&table)))).unwrap();
            let (own, expected) = (&alone.regions[0], &whole.regions[3]);
            assert_eq!((alone.regions.len(), own.region.checksum()), (1, expected.region.checksum()));
            assert_eq!((&own.robots, own.follow), (&expected.robots, expected.follow));
        }
        // A name that the cell has is the new region's, too.
        assert_eq!(cell_with_only(&cell, "end", CART).unwrap().regions[0].region.life, Life::Temporary);
        let fence = "[fence.yard]\ncorners = [[0, 0], [1000, 0], [0, 1000]]\nheight = 2000";
        assert!(matches!(cell_with_only(&cell, "yard", fence).unwrap().regions[0].solid, RegionSolid::Walls(_)));
        let cases = [
            ("cart", "shape = \"cube\"", "cube"),
            ("cart", "shape = \"sphere\"\ncentre = [0, 0, 1]\nradius = 5\nguards = [\"tool\"]", "guards nothing"),
            ("cart", fence, "`fence` is not the table of the region `cart` alone"),
            ("yard", "[fence.yard]\ncorners = [[0, 0], [1000, 0]]\nheight = 2000", "2 corners, not 3 to 500"),
            ("cart", "shape = \"mesh\"\nmesh = \"../../etc/passwd\"\nat = [0, 0, 0]", "outside of the cell's folder"),
            ("cart", "shape = \"sphere\"\ncentre = [0, 0, 1]\nradius = 5\nrobots = [\"left\"]", "left"),
        ];
        for (name, toml, expected) in cases {
            let error = cell_with_only(&cell, name, toml).unwrap_err().to_string();
            assert!(error.contains(expected), "{toml}: {error}");
        }
        let error = file.table_of("yard", fence).unwrap_err().to_string();
        assert!(error.contains("fences are not added while the cell runs"), "{error}");
    }

    #[test]
    fn exchange_and_permanent_regions_and_robots_must_stay() {
        let file = edited();
        let base = file.cell(&[]).unwrap();
        let why = |edits: &[RegionEdit]| why_not_continued(&base, &file.cell(edits).unwrap()).unwrap();
        assert!(why(&[edit("table", None)]).unwrap().contains("exchange"));
        let exchange = CART.replace("life = \"temporary\"", "kind = \"exchange\"");
        assert!(why(&[edit("cart", Some(&exchange))]).unwrap().contains("exchange"));
        let wall = file.table(&[], "wall").unwrap();
        let moved = file.moved("wall", &wall, "centre = [0, 950, 0]").unwrap();
        for edit in [edit("wall", None), edit("wall", Some(&moved))] {
            assert!(why(&[edit]).unwrap().contains("region `wall` is permanent"));
        }
        let permanent = CART.replace("temporary", "permanent");
        assert_eq!(why(&[edit("cart", Some(&permanent))]), None, "one more permanent region only protects");
        let other = EditedRegions::parse("rail.toml", &FILE.replace("max = 2000", "max = 2100")).unwrap();
        assert!(why_not_continued(&base, &other.cell(&[]).unwrap()).unwrap().unwrap().contains("robots"));
    }
}
