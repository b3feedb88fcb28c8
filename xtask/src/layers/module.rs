//! Modules of a crate: the file of each module, its definitions, and its re-exports.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::source::{Token, tokens};
use super::uses::{Import, Use, uses_of};

/// One file of a crate.
pub struct Module {
    /// Path of the file below the crate's `src`, as in `checker/mod.rs`.
    pub file: String,
    /// Paths that the file uses, made absolute (without `crate`).
    pub uses: Vec<Use>,
    /// Local names of its imports.
    imports: BTreeMap<String, Vec<String>>,
    /// Modules whose whole contents it imports.
    globs: Vec<Vec<String>>,
    /// Names that the file defines itself.
    defined: BTreeSet<String>,
}

/// All files of one crate by their module path; the root is the empty path.
pub type Modules = BTreeMap<Vec<String>, Module>;

/// Reads the files below `src`; files of tests and of separate programs are skipped.
pub fn read(src: &Path) -> Result<Modules, String> {
    let mut files = Vec::new();
    collect(src, &mut Vec::new(), &mut files)?;
    let paths: BTreeSet<Vec<String>> = files.iter().map(|(path, ..)| path.clone()).collect();
    Ok(files.into_iter().map(|(path, file, text)| (path.clone(), module(&path, file, &text, &paths))).collect())
}

/// Builds one module from its text. `paths` are the paths of all modules of the crate.
pub fn module(path: &[String], file: String, text: &str, paths: &BTreeSet<Vec<String>>) -> Module {
    let tokens = tokens(text);
    let (uses, imports) = uses_of(&tokens, path, paths);
    let mut names = BTreeMap::new();
    let mut globs = Vec::new();
    for Import { name, target } in imports {
        match name {
            Some(name) => {
                names.insert(name, target);
            }
            None => globs.push(target),
        }
    }
    Module { file, uses, imports: names, globs, defined: defined(&tokens) }
}

type Found = (Vec<String>, String, String);

fn collect(folder: &Path, path: &mut Vec<String>, found: &mut Vec<Found>) -> Result<(), String> {
    let said = |e: std::io::Error| format!("{}: {e}", folder.display());
    let mut entries: Vec<_> = std::fs::read_dir(folder).map_err(said)?.collect::<Result<Vec<_>, _>>().map_err(said)?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let name = entry.file_name().to_string_lossy().into_owned();
        if entry.path().is_dir() {
            if name != "tests" && name != "bin" {
                path.push(name);
                collect(&entry.path(), path, found)?;
                path.pop();
            }
            continue;
        }
        let Some(stem) = name.strip_suffix(".rs").filter(|stem| *stem != "tests") else { continue };
        let text = std::fs::read_to_string(entry.path()).map_err(|e| format!("{}: {e}", entry.path().display()))?;
        let mut module = path.clone();
        if !matches!(stem, "mod" | "lib" | "main") {
            module.push(stem.to_owned());
        }
        let mut file = path.join("/");
        if !file.is_empty() {
            file.push('/');
        }
        found.push((module, file + &name, text));
    }
    Ok(())
}

/// Returns the names after words that define something.
fn defined(tokens: &[Token]) -> BTreeSet<String> {
    const WORDS: [&str; 9] = ["fn", "struct", "enum", "union", "trait", "type", "const", "static", "macro_rules"];
    let mut names = BTreeSet::new();
    for (i, token) in tokens.iter().enumerate() {
        if token.word().is_some_and(|word| WORDS.contains(&word)) {
            let next = tokens[i + 1..].iter().take(2).find_map(|t| t.word().filter(|word| *word != "mut"));
            names.extend(next.map(str::to_owned));
        }
    }
    names
}

/// Returns the module in whose file the item at this absolute path is defined; `None` if the path is a module itself or
/// does not belong to the crate.
pub fn definer(modules: &Modules, path: &[String]) -> Option<Vec<String>> {
    resolve(modules, path, &mut BTreeSet::new())
}

fn resolve(modules: &Modules, path: &[String], seen: &mut BTreeSet<Vec<String>>) -> Option<Vec<String>> {
    if !seen.insert(path.to_vec()) {
        return None;
    }
    let depth = (0..=path.len()).rev().find(|n| modules.contains_key(&path[..*n]))?;
    let (inside, rest) = path.split_at(depth);
    let module = &modules[inside];
    let name = rest.first()?;
    if module.defined.contains(name) {
        return Some(inside.to_vec());
    }
    if let Some(target) = module.imports.get(name) {
        let target: Vec<String> = target.iter().chain(&rest[1..]).cloned().collect();
        return resolve(modules, &target, seen);
    }
    let through = |glob: &Vec<String>| glob.iter().chain(rest).cloned().collect::<Vec<_>>();
    let from_glob = module.globs.iter().find_map(|glob| resolve(modules, &through(glob), seen));
    from_glob.or_else(|| (!inside.is_empty()).then(|| inside.to_vec()))
}
