//! Limits of size. Items that were over a limit when the rule was made are listed by name in `xtask/ratchet.toml`, with
//! their size; the list may only shrink.

mod exceptions;
mod files;
mod measured;
mod reach;
mod sizes;

use std::collections::BTreeMap;
use std::path::Path;

use exceptions::{Exceptions, LIST, Rule};
use measured::Measured;
use toml::Table;

const RULES: [Rule; 4] = [
    Rule {
        section: "lines_of_files",
        limit: 450,
        unit: "lines",
        advice: "move one noun of it to a file of its own, named for it",
    },
    Rule {
        section: "lines_of_functions",
        limit: 60,
        unit: "lines",
        advice: "move one step of it to a function of its own",
    },
    Rule {
        section: "fields_of_structs",
        limit: 15,
        unit: "fields",
        advice: "group fields that belong together in a struct",
    },
    Rule {
        section: "dependencies_of_crates",
        limit: 8,
        unit: "dependencies",
        advice: "use a crate that it has already, or move the work to a crate that has this one",
    },
];

/// Result of the ratchet.
pub struct Outcome {
    /// Every place to change.
    pub problems: Vec<String>,
    /// Number of exceptions in the list.
    pub exceptions: usize,
}

/// Checks the workspace at `root`, whose crates have these manifests. `write` first lowers and removes exceptions that are
/// too large.
pub fn check(root: &Path, manifests: &BTreeMap<String, Table>, write: bool) -> Result<Outcome, String> {
    let files = files::read(root)?;
    let measured = [
        sizes::lines_of_files(&files),
        sizes::lines_of_functions(&files),
        sizes::fields_of_structs(&files),
        sizes::dependencies_of_crates(manifests),
    ];
    let path = root.join(LIST);
    let mut text = std::fs::read_to_string(&path).map_err(|e| format!("{LIST}: {e}"))?;
    if write {
        text = exceptions::lowered(&text, |section, name| needed(&measured, section, name));
        std::fs::write(&path, &text).map_err(|e| format!("{LIST}: {e}"))?;
    }
    let list = exceptions::read(&text, &RULES)?;
    let mut problems = reach::dead_items(&files);
    for (rule, measured) in RULES.iter().zip(&measured) {
        problems.extend(exceptions::problems(rule, measured, &list[rule.section]));
    }
    Ok(Outcome { problems, exceptions: list.values().map(Exceptions::len).sum() })
}

/// Returns the size that an exception has to allow; `None` if none is needed.
fn needed(measured: &[Vec<Measured>; 4], section: &str, name: &str) -> Option<usize> {
    let (rule, measured) = RULES.iter().zip(measured).find(|(rule, _)| rule.section == section)?;
    let size = measured.iter().find(|m| m.name == name)?.value;
    (size > rule.limit).then_some(size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exception_is_needed_only_over_the_limit() {
        let lines = |name: &str, value| Measured { name: name.into(), place: String::new(), value };
        let measured = [vec![lines("a.rs", 451), lines("b.rs", 450)], Vec::new(), Vec::new(), Vec::new()];
        let needed = |name| needed(&measured, "lines_of_files", name);
        assert_eq!([needed("a.rs"), needed("b.rs"), needed("c.rs")], [Some(451), None, None]);
    }
}
