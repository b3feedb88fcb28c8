//! Check of the names in a document: types, functions, crates, examples, benches, tests and files must exist.

use std::collections::HashSet;
use std::path::Path;

/// Names of other libraries and standards.
const FOREIGN: [&str; 5] =
    ["BVHModelOBBRSS", "DistanceResult", "OrbitControls", "computeCollisions", "computeDistances"];

/// Every word of the sources, and the names of the files.
#[derive(Debug, Default)]
pub struct KnownNames {
    words: HashSet<String>,
    paths: Vec<String>,
}

impl KnownNames {
    /// Adds the words of a file's path, and of its text if it is a source.
    pub fn add(&mut self, path: &str, text: &str) {
        self.words.extend(words(path).map(str::to_owned));
        if [".rs", ".toml", ".py"].iter().any(|ending| path.ends_with(ending)) {
            self.words.extend(words(text).map(str::to_owned));
        }
        self.paths.push(path.to_owned());
    }

    /// Lists every name in a document that does not exist.
    pub fn problems(&self, root: &Path, document: &str, text: &str) -> Vec<String> {
        let mut found = Vec::new();
        let mut in_code = false;
        for (i, line) in text.lines().enumerate() {
            let mut report = |what: String| found.push(format!("{document}:{}: {what}", i + 1));
            self.command_names(line).for_each(&mut report);
            if line.trim_start().starts_with("```") {
                in_code = !in_code;
            } else if !in_code {
                line.split('`').skip(1).step_by(2).filter_map(|code| self.unknown(root, code)).for_each(&mut report);
            }
        }
        found
    }

    /// Lists the crates, examples and tests that a command names and that do not exist.
    fn command_names<'a>(&'a self, line: &'a str) -> impl Iterator<Item = String> + 'a {
        let after = |option: &'static str| line.split(option).skip(1).filter_map(|rest| words(rest).next());
        let crates = after("-p elbowroom-").map(|name| (format!("/{name}/Cargo.toml"), format!("crate {name}")));
        let examples = after("--example ").map(|name| (format!("/examples/{name}"), format!("example {name}")));
        let tests = after("--test ").map(|name| (format!("/tests/{name}"), format!("test {name}")));
        let modules =
            line.split("--test main ").skip(1).filter_map(|rest| rest.trim_start_matches("-- ").split_once("::"));
        let modules = modules.map(|(name, _)| (format!("/tests/{name}"), format!("module {name} of tests")));
        let benches = after("--bench ").map(|name| (format!("/benches/{name}"), format!("bench {name}")));
        let exists = |part: &str| self.paths.iter().any(|path| path.contains(part));
        crates
            .chain(examples)
            .chain(tests)
            .chain(modules)
            .chain(benches)
            .filter(move |(part, _)| !exists(part))
            .map(|(_, name)| format!("there is no {name}"))
    }

    /// Says what is wrong with a piece of code in a sentence.
    fn unknown(&self, root: &Path, code: &str) -> Option<String> {
        if is_path(code) {
            return (!root.join(code).exists()).then(|| format!("there is no file `{code}`"));
        }
        if !is_rust(code) && !is_sentence(code) {
            return None;
        }
        let is_known = |word: &&str| self.words.contains(*word) || FOREIGN.contains(word);
        let starts_with_letter =
            |word: &&str| word.len() > 2 && word.is_ascii() && word.starts_with(char::is_alphabetic);
        let unknown = words(code).filter(starts_with_letter).find(|word| !is_known(word))?;
        Some(format!("`{code}`: no source has the name {unknown}"))
    }
}

/// Splits a text into runs of letters, digits and underscores.
fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// Whether the code is the name of a test: words of a sentence.
fn is_sentence(code: &str) -> bool {
    code.matches('_').count() >= 4 && code.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
}

/// Whether the code is a file or folder of the workspace.
fn is_path(code: &str) -> bool {
    const FOLDERS: [&str; 5] = ["crates/", "devtools/", "docs/", "examples/", "xtask/"];
    // `NAME` and `GROUP` in a path stand for any name.
    FOLDERS.iter().any(|folder| code.starts_with(folder))
        && !code.contains([' ', '*', '…', '{', '<', ':', '#'])
        && !["NAME", "GROUP"].iter().any(|any| code.contains(any))
}

/// Whether the code is a path of Rust (`mesh::distance`), or a type, alone or with a suffix (`Scene`, `Scene.step()`).
fn is_rust(code: &str) -> bool {
    let mut start = code.chars();
    let is_type = start.next().is_some_and(char::is_uppercase) && start.next().is_some_and(char::is_lowercase);
    let name = code.split('(').next().unwrap_or_default();
    code.contains("::") || is_type && words(name).count() <= 2 && !name.contains([' ', '-', '/'])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_documents_are_those_of_the_sources() {
        let mut known = KnownNames::default();
        known.add("crates/world/scene/Cargo.toml", "");
        known.add("crates/world/scene/src/scene.rs", "pub struct Scene { step: u32 }");
        known.add("crates/world/scene/examples/sweep.rs", "");
        known.add("crates/world/scene/tests/main.rs", "mod walks;");
        known.add("crates/world/scene/tests/walks.rs", "");
        let problems = |text: &str| known.problems(Path::new("/nowhere"), "a.md", text);
        assert!(problems("`Scene`, `Scene::step(1)` and `run it`\n```\nScenery::walk\n```").is_empty());
        assert!(problems("cargo run -p elbowroom-scene --example sweep").is_empty());
        assert!(problems("cargo test -p elbowroom-scene --test main walks:: -- --nocapture").is_empty());
        assert_eq!(problems("cargo test --test main runs::all"), ["a.md:1: there is no module runs of tests"]);
        assert_eq!(problems("text\n`Scenery`"), ["a.md:2: `Scenery`: no source has the name Scenery"]);
        assert_eq!(
            problems("`it_was_here_once_and_is_gone`"),
            ["a.md:1: `it_was_here_once_and_is_gone`: no source has the name it_was_here_once_and_is_gone"]
        );
        assert_eq!(problems("cargo test -p elbowroom-plan"), ["a.md:1: there is no crate plan"]);
        assert_eq!(
            problems("see `crates/world/scene/src/gone.rs`"),
            ["a.md:1: there is no file `crates/world/scene/src/gone.rs`"]
        );
    }
}
