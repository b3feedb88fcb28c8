//! List of exceptions: items that were over a limit when the rule was made. It may only shrink.

use std::collections::BTreeMap;

use toml::{Table, Value};

use super::measured::Measured;

/// Path of the list, below the root of the workspace.
pub const LIST: &str = "xtask/ratchet.toml";

/// A limit of the ratchet.
#[derive(Debug, Clone, Copy)]
pub struct Rule {
    /// Section of the list with its exceptions.
    pub section: &'static str,
    /// The largest size that needs no exception.
    pub limit: usize,
    /// Unit of the count.
    pub unit: &'static str,
    /// Advice for items over the limit.
    pub advice: &'static str,
}

/// The exceptions of one rule: name → the size that is accepted.
pub type Exceptions = BTreeMap<String, usize>;

/// Reads the exceptions of all `rules` from the text of the list.
pub fn read(text: &str, rules: &[Rule]) -> Result<BTreeMap<&'static str, Exceptions>, String> {
    let table: Table = text.parse().map_err(|e| format!("{LIST}: {e}"))?;
    if let Some(unknown) = table.keys().find(|key| rules.iter().all(|rule| rule.section != *key)) {
        let known: Vec<&str> = rules.iter().map(|rule| rule.section).collect();
        return Err(format!("{LIST}: [{unknown}] is not a section of the list; write one of {}", known.join(", ")));
    }
    let mut found = BTreeMap::new();
    for rule in rules {
        let mut exceptions = Exceptions::new();
        for (name, value) in table.get(rule.section).and_then(Value::as_table).into_iter().flatten() {
            let size = value.as_integer().and_then(|size| usize::try_from(size).ok());
            let size = size.ok_or_else(|| format!("{LIST}: \"{name}\": write a whole number of {}", rule.unit))?;
            exceptions.insert(name.clone(), size);
        }
        found.insert(rule.section, exceptions);
    }
    Ok(found)
}

/// Lists items that are over the limit without an exception or have outgrown it, and exceptions that are too large.
pub fn problems(rule: &Rule, measured: &[Measured], exceptions: &Exceptions) -> Vec<String> {
    let Rule { section, limit, unit, advice } = rule;
    let mut found = Vec::new();
    for Measured { name, place, value } in measured {
        let Some(&listed) = exceptions.get(name) else {
            if value > limit {
                found.push(format!("{place}: {name} has {value} {unit}, at most {limit} are allowed: {advice}"));
            }
            continue;
        };
        if *value > listed {
            found.push(format!("{place}: {name} has grown from {listed} to {value} {unit}: {advice}"));
        } else if value <= limit {
            found.push(format!(
                "{LIST}: [{section}] \"{name}\" has {value} {unit} now and needs no exception: remove the entry{BY_COMMAND}"
            ));
        } else if *value < listed {
            found.push(format!(
                "{LIST}: [{section}] \"{name}\" has {value} {unit} now: lower the entry from {listed}{BY_COMMAND}"
            ));
        }
    }
    let is_gone = |name: &&String| measured.iter().all(|m| m.name != **name);
    found.extend(exceptions.keys().filter(is_gone).map(|name| {
        format!("{LIST}: [{section}] \"{name}\" exists no more: remove the entry{BY_COMMAND}, or give it the new name")
    }));
    found
}

const BY_COMMAND: &str = " (`cargo xtask layers --write` does it)";

/// Returns the text of the list with each entry lowered to its size in `sizes`, or removed; nothing is added or raised.
/// `sizes` returns the size for a section and a name, `None` if the exception is no longer needed.
pub fn lowered(text: &str, sizes: impl Fn(&str, &str) -> Option<usize>) -> String {
    let mut section = String::new();
    let mut kept = String::new();
    for line in text.lines() {
        let trimmed = line.trim();
        if let Some(name) = trimmed.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
            name.clone_into(&mut section);
        }
        let Some((name, listed)) = entry(trimmed) else {
            kept.extend([line, "\n"]);
            continue;
        };
        if let Some(size) = sizes(&section, name) {
            kept.extend(["\"", name, "\" = ", &size.min(listed).to_string(), "\n"]);
        }
    }
    kept
}

/// Parses the name and size of a line `"NAME" = SIZE`.
fn entry(line: &str) -> Option<(&str, usize)> {
    let (name, size) = line.strip_prefix('"')?.split_once("\" = ")?;
    Some((name, size.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULE: Rule = Rule { section: "fields", limit: 15, unit: "fields", advice: "group them" };

    fn problem(value: usize, listed: Option<usize>) -> Vec<String> {
        let measured = [Measured { name: "a.rs: A".into(), place: "a.rs:7".into(), value }];
        problems(&RULE, &measured, &listed.map(|size| ("a.rs: A".to_owned(), size)).into_iter().collect())
    }

    #[test]
    fn what_is_within_the_limit_or_as_listed_passes() {
        assert!(problem(15, None).is_empty());
        assert!(problem(20, Some(20)).is_empty());
    }

    #[test]
    fn what_is_over_the_limit_and_not_listed_is_found() {
        let expected = "a.rs:7: a.rs: A has 16 fields, at most 15 are allowed: group them";
        assert_eq!(problem(16, None), [expected]);
    }

    #[test]
    fn what_has_grown_is_found() {
        assert_eq!(problem(21, Some(20)), ["a.rs:7: a.rs: A has grown from 20 to 21 fields: group them"]);
    }

    #[test]
    fn an_entry_that_is_too_large_is_found() {
        assert!(problem(19, Some(20))[0].contains("has 19 fields now: lower the entry from 20"));
        assert!(problem(15, Some(20))[0].contains("needs no exception: remove the entry"));
    }

    #[test]
    fn an_entry_of_nothing_is_found() {
        let found = problems(&RULE, &[], &Exceptions::from([("b.rs: B".to_owned(), 20)]));
        assert!(found[0].contains("\"b.rs: B\" exists no more"), "{found:?}");
    }

    #[test]
    fn the_list_is_read_and_its_mistakes_are_named() {
        let list = read("[fields]\n\"a.rs: A\" = 20\n", &[RULE]).unwrap();
        assert_eq!(list["fields"], Exceptions::from([("a.rs: A".to_owned(), 20)]));
        assert!(read("[other]\n", &[RULE]).unwrap_err().contains("write one of fields"));
        assert!(read("[fields]\n\"a.rs: A\" = \"20\"\n", &[RULE]).unwrap_err().contains("a whole number of fields"));
    }

    #[test]
    fn writing_lowers_and_removes_but_never_raises_or_adds() {
        let text =
            "# Why.\n[fields]\n\"a.rs: A\" = 20\n\"b.rs: B\" = 20\n\"c.rs: C\" = 20\n[lines]\n\"a.rs: A\" = 20\n";
        let sizes = |section: &str, name: &str| match (section, name) {
            ("fields", "a.rs: A") => Some(18),
            ("fields", "b.rs: B") => Some(30),
            ("lines", _) => Some(20),
            _ => None,
        };
        let expected = "# Why.\n[fields]\n\"a.rs: A\" = 18\n\"b.rs: B\" = 20\n[lines]\n\"a.rs: A\" = 20\n";
        assert_eq!(lowered(text, sizes), expected);
    }
}
