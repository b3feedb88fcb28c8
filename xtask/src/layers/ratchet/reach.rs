//! Public items that nothing reaches: their name occurs as a word in no other file of the workspace, and in no example of
//! the documentation. The test compares words: an unreached item with a common name is not found.

use std::collections::{HashMap, HashSet};

use super::files::SourceFile;
use super::sizes::line_of;
use crate::layers::source::{Token, tokens};

/// Lists every public item that nothing reaches, as a line with place and advice.
pub fn dead_items(files: &[SourceFile]) -> Vec<String> {
    let sources: Vec<Vec<Token>> =
        files.iter().map(|file| if is_rust(file) { tokens(&whole(&file.text)) } else { Vec::new() }).collect();
    let mut holders: HashMap<String, Holder> = HashMap::new();
    for (i, file) in files.iter().enumerate() {
        let mut see = |word: &str| {
            holders.entry(word.to_owned()).and_modify(|h| h.see(i)).or_insert(Holder::One(i));
        };
        if is_rust(file) {
            without_own_exports(&sources[i]).filter_map(Token::word).for_each(&mut see);
        } else {
            words(&file.text).for_each(&mut see);
        }
    }
    let examples: HashSet<String> = files.iter().flat_map(|file| words_of_examples(&file.text)).collect();
    let mut found = Vec::new();
    for (i, file) in files.iter().enumerate().filter(|(_, file)| file.is_measured) {
        let inside = tokens(&file.text);
        let seen = seen_in_signatures(&inside);
        for (kind, name) in public_items(&inside) {
            let is_reached = holders.get(name).is_some_and(|holder| !matches!(holder, Holder::One(j) if *j == i));
            if is_reached || examples.contains(name) || (is_type(kind) && seen.contains(name)) {
                continue;
            }
            let line = line_of(&file.text, &format!("{kind} {name}"));
            found.push(format!(
                "{}:{line}: nothing outside this file uses the public {kind} {name}: {ADVICE}",
                file.path
            ));
        }
    }
    found
}

const ADVICE: &str = "delete it, or make it private; a user's item is shown in an example of its documentation";

/// Files in which a word occurs.
enum Holder {
    One(usize),
    Many,
}

impl Holder {
    fn see(&mut self, file: usize) {
        if !matches!(self, Self::One(seen) if *seen == file) {
            *self = Self::Many;
        }
    }
}

fn is_rust(file: &SourceFile) -> bool {
    std::path::Path::new(&file.path).extension().is_some_and(|ending| ending == "rs")
}

/// Moves the unit tests of a text from the end to the middle, so that [`tokens`] keeps them.
fn whole(text: &str) -> String {
    text.replace("#[cfg(test)]\nmod ", "#[cfg(test)]\n\nmod ")
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty())
}

/// Returns the words of the examples in documentation comments.
fn words_of_examples(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut is_inside = false;
    for line in text.lines().map(str::trim_start) {
        let Some(line) = line.strip_prefix("///").or_else(|| line.strip_prefix("//!")) else {
            is_inside = false;
            continue;
        };
        if line.trim_start().starts_with("```") {
            is_inside = !is_inside;
        } else if is_inside {
            found.extend(words(line).map(str::to_owned));
        }
    }
    found
}

/// Removes `pub use` of the crate's own items from the tokens: a re-exported name is not used yet.
fn without_own_exports(tokens: &[Token]) -> impl Iterator<Item = &Token> {
    let mut is_export = false;
    tokens.iter().enumerate().filter_map(move |(i, token)| {
        let word = |at: usize| tokens.get(at).and_then(Token::word);
        if word(i) == Some("pub") {
            let start = if tokens.get(i + 1).is_some_and(|t| t.is('(')) { i + 4 } else { i + 1 };
            let is_foreign = word(start + 1).is_some_and(|first| first.starts_with("elbowroom"));
            is_export = word(start) == Some("use") && !is_foreign;
        }
        let is_kept = !is_export;
        if token.is(';') {
            is_export = false;
        }
        is_kept.then_some(token)
    })
}

fn is_type(kind: &str) -> bool {
    matches!(kind, "struct" | "enum" | "union" | "trait" | "type")
}

/// Returns kind and name of every item that is `pub` without restriction.
fn public_items(tokens: &[Token]) -> Vec<(&str, &str)> {
    let mut found = Vec::new();
    for i in 0..tokens.len() {
        if tokens[i].word() != Some("pub") {
            continue;
        }
        let mut rest = tokens[i + 1..].iter().map(Token::word).peekable();
        // `const` is an item, or a word before `fn`.
        let mut kind = rest.next().flatten();
        while matches!(kind, Some("const" | "async" | "unsafe")) && matches!(rest.peek(), Some(Some("fn" | "unsafe"))) {
            kind = rest.next().flatten();
        }
        if let (Some(kind @ ("fn" | "const" | "static" | "struct" | "enum" | "union" | "trait" | "type")), Some(name)) =
            (kind, rest.next().flatten())
        {
            found.push((kind, name));
        }
    }
    found
}

/// Returns the words of signatures, fields, variants, traits, aliases and types of constants: a type that occurs there is
/// reached through them.
fn seen_in_signatures(tokens: &[Token]) -> HashSet<&str> {
    let mut seen = HashSet::new();
    for i in 0..tokens.len() {
        let end = match tokens[i].word() {
            Some("fn" | "type" | "const" | "static") => end_of_item(&tokens[i..], false),
            Some("enum" | "trait" | "struct") => end_of_item(&tokens[i..], true),
            _ => None,
        };
        if let Some(end) = end {
            // After the item's own name.
            seen.extend(tokens[(i + 2).min(i + end)..i + end].iter().filter_map(Token::word));
        }
    }
    seen
}

/// Finds the end of the item at the start of `tokens`: its semicolon, or its block, which is part of it if `with_block`.
fn end_of_item(tokens: &[Token], with_block: bool) -> Option<usize> {
    let mut depth = 0_usize;
    for (i, token) in tokens.iter().enumerate() {
        match token {
            Token::Sign(';') if depth == 0 => return Some(i),
            Token::Sign('{') if depth == 0 && !with_block => return Some(i),
            Token::Sign('{' | '(' | '[') => depth += 1,
            Token::Sign(')' | ']') => depth = depth.checked_sub(1)?,
            Token::Sign('}') => {
                depth = depth.checked_sub(1)?;
                if depth == 0 {
                    return Some(i);
                }
            }
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the dead items of `a.rs` with this text beside `others`.
    fn dead(text: &str, others: &[(&str, &str)]) -> Vec<String> {
        let file =
            |path: &str, text: &str, is_measured| SourceFile { path: path.into(), text: text.into(), is_measured };
        let mut files = vec![file("a.rs", text, true)];
        files.extend(others.iter().map(|(path, text)| file(path, text, false)));
        dead_items(&files)
    }

    #[test]
    fn an_item_that_no_other_file_names_is_dead() {
        let found = dead("fn c() {}\npub const fn b() {\n    b();\n}\n", &[("b.rs", "fn d() {} // b\n")]);
        assert_eq!(found.len(), 1);
        assert!(found[0].starts_with("a.rs:2: nothing outside this file uses the public fn b: delete it"), "{found:?}");
    }

    #[test]
    fn other_files_documents_and_examples_reach_an_item() {
        let text = "pub fn b() {}\n";
        assert!(dead(text, &[("c.rs", "fn c() { b() }")]).is_empty());
        assert!(dead(text, &[("c.rs", "#[cfg(test)]\nmod tests {\n    fn c() { b() }\n}\n")]).is_empty());
        assert!(dead(text, &[("docs/c.md", "Call `b`.")]).is_empty());
        assert!(dead("/// ```\n/// b();\n/// ```\npub fn b() {}\n", &[]).is_empty());
        assert_eq!(dead("/// Like b.\npub fn b() {}\n", &[]).len(), 1);
    }

    #[test]
    fn an_export_of_its_own_crate_does_not_reach_an_item_but_one_of_another_crate_does() {
        let text = "pub fn b() {}\n";
        assert_eq!(dead(text, &[("lib.rs", "mod a;\npub use a::{b, c};\n")]).len(), 1);
        assert_eq!(dead(text, &[("lib.rs", "pub(crate) use a::b;\n")]).len(), 1);
        assert!(dead(text, &[("lib.rs", "pub use a::c;\nfn d() { b() }")]).is_empty());
        assert!(dead(text, &[("lib.rs", "pub use elbowroom_a::b;\n")]).is_empty());
    }

    #[test]
    fn a_type_is_reached_through_signatures_fields_and_variants() {
        for user in [
            "pub fn b(c: [u8; 3]) -> X {}",
            "pub struct B {\n    x: X,\n}",
            "pub enum B {\n    X(X),\n}",
            "type B = X;",
        ] {
            let found = dead(&format!("pub struct X;\n{user}\n"), &[("b.rs", "B b")]);
            assert!(found.is_empty(), "{user}: {found:?}");
        }
        assert_eq!(dead("pub struct X;\npub fn b() { X }\n", &[("b.rs", "b")]).len(), 1);
        assert_eq!(dead("pub struct X {\n    y: u8,\n}\n", &[]).len(), 1);
    }

    #[test]
    fn items_of_restricted_visibility_are_not_public() {
        assert!(dead("pub(crate) fn b() {}\npub(super) struct C;\nfn d() {}\npub use e::F;\n", &[]).is_empty());
    }
}
