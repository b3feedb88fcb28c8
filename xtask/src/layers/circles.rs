//! Cycles of files: files of one crate that use each other, directly or through others.
//!
//! A file that only declares and re-exports is passed through: an import of `crate::Name` uses the file that defines
//! `Name`. Unit tests may use any file.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::module::{Modules, definer, read};

/// File → the files that it uses, each with the names used.
type Graph = BTreeMap<String, BTreeMap<String, BTreeSet<String>>>;

/// Finds the cycles of the crate whose sources are in `src`: each as lines `a.rs -> b.rs: names`.
pub fn circles_of(src: &Path) -> Result<Vec<Vec<String>>, String> {
    let graph = graph(&read(src)?);
    Ok(circles(&graph).iter().map(|files| described(&graph, files)).collect())
}

fn graph(modules: &Modules) -> Graph {
    let mut graph = Graph::new();
    for module in modules.values() {
        let entry = graph.entry(module.file.clone()).or_default();
        for path in &module.uses {
            let Some(used) = definer(modules, path) else { continue };
            let file = &modules[&used].file;
            if *file != module.file {
                entry.entry(file.clone()).or_default().insert(path.last().cloned().unwrap_or_default());
            }
        }
    }
    graph
}

/// Finds groups of files in which each file reaches every other.
fn circles(graph: &Graph) -> Vec<Vec<String>> {
    let reached: BTreeMap<&String, BTreeSet<&String>> = graph.keys().map(|file| (file, reach(graph, file))).collect();
    let mut grouped = BTreeSet::new();
    let mut found = Vec::new();
    for (file, far) in &reached {
        if !far.contains(file) || grouped.contains(file) {
            continue;
        }
        let group: Vec<String> =
            far.iter().filter(|other| reached[**other].contains(file)).map(|other| (*other).clone()).collect();
        grouped.extend(reached.keys().copied().filter(|f| group.contains(f)));
        found.push(group);
    }
    found
}

fn reach<'g>(graph: &'g Graph, from: &String) -> BTreeSet<&'g String> {
    let mut seen = BTreeSet::new();
    let mut open: Vec<&String> = graph[from].keys().collect();
    while let Some(file) = open.pop() {
        if seen.insert(file) {
            open.extend(graph.get(file).into_iter().flat_map(BTreeMap::keys));
        }
    }
    seen
}

fn described(graph: &Graph, files: &[String]) -> Vec<String> {
    let mut lines = Vec::new();
    for file in files {
        for (used, names) in graph[file].iter().filter(|(used, _)| files.contains(used)) {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            lines.push(format!("{file} -> {used}: {}", names.join(", ")));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::super::module::module;
    use super::*;

    /// Makes a crate of these files (module path and text), and finds its cycles.
    fn found(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let path = |name: &str| -> Vec<String> {
            name.trim_end_matches(".rs")
                .split('/')
                .filter(|part| !matches!(*part, "lib" | "mod"))
                .map(str::to_owned)
                .collect()
        };
        let paths: BTreeSet<Vec<String>> = files.iter().map(|(name, _)| path(name)).collect();
        let modules: Modules = files
            .iter()
            .map(|(name, text)| (path(name), module(&path(name), (*name).to_owned(), text, &paths)))
            .collect();
        circles(&graph(&modules))
    }

    #[test]
    fn two_files_that_use_each_other_are_a_circle() {
        let a = ("a.rs", "use crate::b::B; pub struct A;");
        assert_eq!(
            found(&[("lib.rs", "mod a; mod b;"), a, ("b.rs", "use crate::a::A; pub struct B;")]),
            [["a.rs", "b.rs"]]
        );
        assert!(found(&[("lib.rs", "mod a; mod b;"), a, ("b.rs", "pub struct B;")]).is_empty());
    }

    #[test]
    fn re_exports_are_looked_through() {
        let lib = ("lib.rs", "mod a; mod b; pub use a::A; pub use b::*;");
        let b = ("b.rs", "pub struct B; fn f() -> crate::A { todo() }");
        assert_eq!(found(&[lib, ("a.rs", "use crate::{B, other::C}; pub struct A;"), b]), [["a.rs", "b.rs"]]);
    }

    #[test]
    fn longer_circles_and_those_through_a_parent_are_found() {
        let lib = ("lib.rs", "mod a; mod b; mod c;");
        let files = [
            lib,
            ("a.rs", "use crate::b::B; struct A;"),
            ("b.rs", "fn f(c: super::c::C) {} struct B;"),
            ("c.rs", "use super::a::{self}; struct C(a::A);"),
        ];
        assert_eq!(found(&files), [["a.rs", "b.rs", "c.rs"]]);
        let parent = [
            ("lib.rs", "mod p;"),
            ("p/mod.rs", "mod child; use child::run; pub struct Shared;"),
            ("p/child.rs", "use super::Shared; pub fn run() {}"),
        ];
        assert_eq!(found(&parent), [["p/child.rs", "p/mod.rs"]]);
    }

    #[test]
    fn unit_tests_and_comments_make_no_circle() {
        let a = ("a.rs", "use crate::b::B; pub struct A;");
        let b = ("b.rs", "// use crate::a::A;\npub struct B;\n#[cfg(test)]\nmod tests {\n use crate::a::A;\n}\n");
        assert!(found(&[("lib.rs", "mod a; mod b;"), a, b]).is_empty());
    }
}
