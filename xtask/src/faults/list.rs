//! List of the faults, `xtask/faults.toml`.

use std::collections::BTreeSet;
use std::path::Path;

use toml::{Table, Value};

/// Path of the list, below the root.
pub const LIST: &str = "xtask/faults.toml";

/// A mistake that a careful engineer could make, and that the tests must find.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// Its name in the list and on the command line.
    pub name: String,
    /// Name of the crate, without `elbowroom-`.
    pub crate_name: String,
    /// Path of the source file, from the root.
    pub file: String,
    /// Text that occurs once in the file.
    pub find: String,
    /// The text that replaces it.
    pub replace: String,
    /// The effect that the fault would have for a user.
    pub why: String,
}

impl Fault {
    /// Returns the text of the file with the fault.
    ///
    /// # Errors
    /// If the text to find does not occur exactly once.
    pub fn planted(&self, source: &str) -> Result<String, String> {
        match source.matches(&self.find).count() {
            1 => Ok(source.replacen(&self.find, &self.replace, 1)),
            count => Err(format!(
                "fault `{}`: the text to find occurs {count} times in {}, not once: write another `find` in {LIST}",
                self.name, self.file
            )),
        }
    }
}

/// Reads the list below `root`.
///
/// # Errors
/// If the file cannot be read, or an entry is incomplete.
pub fn read(root: &Path) -> Result<Vec<Fault>, String> {
    let text = std::fs::read_to_string(root.join(LIST)).map_err(|e| format!("{LIST}: {e}"))?;
    parse(&text).map_err(|e| format!("{LIST}: {e}"))
}

fn parse(text: &str) -> Result<Vec<Fault>, String> {
    let table: Table = text.parse().map_err(|e| format!("{e}"))?;
    if let Some(key) = table.keys().find(|key| *key != "fault") {
        return Err(format!("`{key}` is unknown: the list has entries [[fault]]"));
    }
    let entries = table.get("fault").and_then(Value::as_array).ok_or("there is no entry [[fault]]")?;
    let faults: Vec<Fault> = entries.iter().map(fault).collect::<Result<_, _>>()?;
    let mut names = BTreeSet::new();
    match faults.iter().find(|fault| !names.insert(&fault.name)) {
        Some(twice) => Err(format!("two faults are called `{}`", twice.name)),
        None => Ok(faults),
    }
}

fn fault(entry: &Value) -> Result<Fault, String> {
    const KEYS: [&str; 6] = ["name", "crate", "file", "find", "replace", "why"];
    let name = entry.get("name").and_then(Value::as_str).ok_or("an entry has no `name`")?;
    let unknown = entry.as_table().into_iter().flat_map(Table::keys).find(|key| !KEYS.contains(&key.as_str()));
    if let Some(key) = unknown {
        return Err(format!("fault `{name}`: `{key}` is unknown; the keys are {}", KEYS.join(", ")));
    }
    let text = |key: &str| {
        let value = entry.get(key).and_then(Value::as_str).map(str::to_owned);
        value.ok_or_else(|| format!("fault `{name}` has no text `{key}`"))
    };
    let (find, replace) = (text("find")?, text("replace")?);
    if find.is_empty() || find == replace {
        return Err(format!("fault `{name}`: `find` is empty, or `replace` changes nothing"));
    }
    let (crate_name, file) = (text("crate")?, text("file")?);
    if !file.starts_with("crates/") || !file.contains(&format!("/{crate_name}/src/")) {
        return Err(format!("fault `{name}`: `{file}` is not in the sources of the crate {crate_name}"));
    }
    Ok(Fault { name: name.to_owned(), crate_name, file, find, replace, why: text("why")? })
}

#[cfg(test)]
mod tests {
    use super::*;

    const ENTRY: &str = "[[fault]]\nname = \"sign\"\ncrate = \"spatial\"\nfile = \"crates/base/spatial/src/vec3.rs\"\n\
        find = '''\na\n+ b'''\nreplace = \"a - b\"\nwhy = \"a wrong sum\"\n";

    #[test]
    fn entries_are_read() {
        let found = parse(ENTRY).unwrap();
        assert_eq!((found.len(), found[0].find.as_str(), found[0].why.as_str()), (1, "a\n+ b", "a wrong sum"));
    }

    #[test]
    fn entries_that_are_not_whole_are_refused() {
        assert!(parse("").is_err());
        assert!(parse(&ENTRY.repeat(2)).unwrap_err().contains("two faults are called `sign`"));
        assert!(parse(&ENTRY.replace("why", "because")).unwrap_err().contains("`because` is unknown"));
        assert!(parse(&ENTRY.replace("why = \"a wrong sum\"", "")).unwrap_err().contains("no text `why`"));
        assert!(parse(&ENTRY.replace("a - b", "a\\n+ b")).unwrap_err().contains("changes nothing"));
        assert!(parse(&ENTRY.replace("\"spatial\"", "\"robot\"")).unwrap_err().contains("not in the sources"));
    }

    #[test]
    fn the_text_to_find_must_occur_exactly_once() {
        let fault = &parse(ENTRY).unwrap()[0];
        assert_eq!(fault.planted("let c = a\n+ b;"), Ok("let c = a - b;".into()));
        assert!(fault.planted("let c = a + b;").unwrap_err().contains("occurs 0 times"));
        assert!(fault.planted("a\n+ b; a\n+ b;").unwrap_err().contains("occurs 2 times"));
    }

    #[test]
    fn the_list_of_the_project_has_a_fault_in_every_crate_with_logic() {
        let root = xtask::call::workspace_root().unwrap();
        let faults = read(&root).unwrap();
        let without_logic = ["testkit", "elbowroom"];
        let crates = xtask::crates::find(&root).unwrap();
        let missing = crates.iter().map(|found| found.name.as_str()).filter(|name| !without_logic.contains(name));
        let missing: Vec<&str> = missing.filter(|name| faults.iter().all(|fault| fault.crate_name != **name)).collect();
        assert_eq!(missing, Vec::<&str>::new());
    }
}
