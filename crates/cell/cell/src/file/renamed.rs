//! Renamed keys and values of the cell file. The old spelling is read for one version, with a warning that names the
//! new one.

use std::path::Path;

use elbowroom_formats::{FormatError, Warning};

use super::node::{Data, Entry};

/// A renamed key.
struct RenamedKey {
    /// The table that has the key, as names separated by dots; `*` stands for any name.
    table: &'static str,
    old: &'static str,
    new: &'static str,
}

/// A renamed value of a key.
struct RenamedValue {
    /// The key and its tables, like [`RenamedKey::table`].
    key: &'static str,
    old: &'static str,
    new: &'static str,
}

const KEYS: [RenamedKey; 2] = [
    RenamedKey { table: "robot.*", old: "foot", new: "base_link" },
    RenamedKey { table: "avoidance.*", old: "patience", new: "stall_timeout" },
];

const VALUES: [RenamedValue; 1] =
    [RenamedValue { key: "object.*.motion.repeat", old: "back and forth", new: "ping-pong" }];

/// The entries of a cell file in the new spelling.
///
/// # Errors
/// A table has a key in both spellings.
pub(super) fn with_new_names(
    file: &Path,
    entries: &[Entry],
    warnings: &mut Vec<Warning>,
) -> Result<Vec<Entry>, FormatError> {
    let mut renamed = entries.to_vec();
    rename(file, &mut Vec::new(), &mut renamed, warnings)?;
    Ok(renamed)
}

/// Renames in the table of the name `path`, and in its tables.
fn rename(
    file: &Path,
    path: &mut Vec<String>,
    entries: &mut [Entry],
    warnings: &mut Vec<Warning>,
) -> Result<(), FormatError> {
    for at in 0..entries.len() {
        let key = KEYS.iter().find(|k| k.old == entries[at].key && matches(path, k.table));
        if let Some(RenamedKey { old, new, .. }) = key {
            let name = format!("{}.{old}", path.join("."));
            let line = entries[at].line;
            if entries.iter().any(|e| e.key == *new) {
                let what = format!("`{name}` is the old name of `{new}`, which is given, too");
                return Err(FormatError::new(file, line, what).hint("leave it out"));
            }
            let what = format!("`{name}` has a new name, `{new}`; a later version will not read the old one");
            warnings.push(Warning::new(file, line, what).hint(format!("{new} = …")));
            (*new).clone_into(&mut entries[at].key);
        }
        let Entry { key, node, .. } = &mut entries[at];
        path.push(key.clone());
        match &mut node.data {
            Data::Table(inner) => rename(file, path, inner, warnings)?,
            Data::Text(text) => {
                if let Some(value) = VALUES.iter().find(|v| v.old == text && matches(path, v.key)) {
                    let RenamedValue { old, new, .. } = value;
                    let name = path.join(".");
                    let what = format!(
                        "`{name}`: \"{old}\" has a new name, \"{new}\"; a later version will not read the old one"
                    );
                    warnings.push(Warning::new(file, node.line, what).hint(format!("{key} = \"{new}\"")));
                    (*new).clone_into(text);
                }
            }
            _ => {}
        }
        path.pop();
    }
    Ok(())
}

fn matches(path: &[String], pattern: &str) -> bool {
    let mut names = pattern.split('.');
    path.iter().all(|name| names.next().is_some_and(|p| p == "*" || p == name)) && names.next().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::node::parse;

    const OLD: &str = "[robot.a]
foot = []
[object.cart]
motion = { repeat = \"back and forth\" }
[avoidance.a]
patience = 1
[region.foot]
patience = 1
";

    fn keys(entries: &[Entry], out: &mut Vec<String>) {
        for e in entries {
            out.push(e.key.clone());
            match &e.node.data {
                Data::Table(inner) => keys(inner, out),
                Data::Text(text) => out.push(text.clone()),
                _ => {}
            }
        }
    }

    #[test]
    fn every_old_name_is_read_with_a_warning_that_names_the_new_one() {
        let file = Path::new("cell.toml");
        let mut warnings = Vec::new();
        let renamed = with_new_names(file, &parse(file, OLD).unwrap(), &mut warnings).unwrap();
        let mut found = Vec::new();
        keys(&renamed, &mut found);
        for (old, new) in KEYS.iter().map(|k| (k.old, k.new)).chain(VALUES.iter().map(|v| (v.old, v.new))) {
            assert_eq!(found.iter().filter(|k| *k == new).count(), 1, "{new}");
            let text = warnings
                .iter()
                .map(ToString::to_string)
                .find(|w| w.contains(&format!("{new} = ")) || w.contains(&format!("\"{new}\"")));
            let text = text.unwrap_or_else(|| panic!("no warning names {new}"));
            assert!(text.contains(old), "{text}");
        }
        assert_eq!(warnings.len(), KEYS.len() + VALUES.len());
        assert_eq!(warnings.iter().map(|w| w.line).collect::<Vec<_>>(), [2, 4, 6].map(Some));
        // A name chosen by the user, and a key of another table.
        assert_eq!(found.iter().filter(|k| *k == "foot" || *k == "patience").count(), 2, "{found:?}");
    }

    #[test]
    fn new_names_cause_no_warning_and_both_names_are_an_error() {
        let file = Path::new("cell.toml");
        let mut warnings = Vec::new();
        let new = "[avoidance.a]\nstall_timeout = 1\n";
        with_new_names(file, &parse(file, new).unwrap(), &mut warnings).unwrap();
        assert!(warnings.is_empty());
        let both = format!("{new}patience = 2\n");
        let error = with_new_names(file, &parse(file, &both).unwrap(), &mut warnings).unwrap_err();
        assert_eq!(error.line, Some(3));
        assert!(error.to_string().contains("stall_timeout"), "{error}");
    }
}
