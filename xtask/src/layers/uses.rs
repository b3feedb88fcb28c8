//! Uses of a file in its own crate: `use` trees and paths in expressions.

use std::collections::{BTreeMap, BTreeSet};

use super::source::Token;

/// An absolute path (without `crate`) that a file names.
pub type Use = Vec<String>;

/// A name imported by `use`; without a name if everything of the target is imported.
pub struct Import {
    /// The local name.
    pub name: Option<String>,
    /// The path that it stands for.
    pub target: Use,
}

/// Returns everything that these tokens of the module `path` use of the crate whose modules are `paths`, and their imports.
pub fn uses_of(tokens: &[Token], path: &[String], paths: &BTreeSet<Vec<String>>) -> (Vec<Use>, Vec<Import>) {
    let place = Place { path, paths };
    let (mut uses, mut imports, mut at) = (Vec::new(), Vec::new(), 0);
    let mut written = Vec::new();
    while at < tokens.len() {
        match tokens[at].word() {
            Some("use") => {
                let mut leaves = Vec::new();
                at = tree(tokens, at + 1, &[], &mut leaves);
                for (leaf, name) in leaves {
                    let Some(target) = place.absolute(&leaf) else { continue };
                    uses.push(target.clone());
                    imports.push(Import { name, target });
                }
            }
            Some(_) if at == 0 || !matches!(tokens[at - 1], Token::Path) && !tokens[at - 1].is('.') => {
                let (words, next) = plain_path(tokens, at);
                if words.len() > 1 {
                    written.push(words);
                }
                at = next;
            }
            _ => at += 1,
        }
    }
    let local: BTreeMap<&str, &Use> = imports.iter().filter_map(|i| Some((i.name.as_deref()?, &i.target))).collect();
    for words in written {
        let imported = local.get(words[0].as_str());
        let full = imported.map(|target| target.iter().chain(&words[1..]).cloned().collect());
        uses.extend(full.or_else(|| place.absolute(&words)));
    }
    (uses, imports)
}

struct Place<'a> {
    path: &'a [String],
    paths: &'a BTreeSet<Vec<String>>,
}

impl Place<'_> {
    /// Returns the path from the crate's root; `None` for other crates.
    fn absolute(&self, words: &[String]) -> Option<Use> {
        let (first, rest) = words.split_first()?;
        let mut base = self.path.to_vec();
        match first.as_str() {
            "crate" => base.clear(),
            "self" => {}
            "super" => {
                base.pop();
                let ups = rest.iter().take_while(|word| *word == "super").count();
                base.truncate(base.len().saturating_sub(ups));
                return Some(base.into_iter().chain(rest[ups..].iter().cloned()).collect());
            }
            child => {
                base.push(child.to_owned());
                self.paths.contains(&base).then_some(())?;
            }
        }
        Some(base.into_iter().chain(rest.iter().cloned()).collect())
    }
}

type Leaf = (Vec<String>, Option<String>);

/// Reads one branch of a `use` tree that starts at `at`, below `prefix`; returns the position of its end.
fn tree(tokens: &[Token], mut at: usize, prefix: &[String], leaves: &mut Vec<Leaf>) -> usize {
    let mut path = prefix.to_vec();
    while at < tokens.len() {
        match &tokens[at] {
            Token::Word(word) if word == "as" => {
                let name = tokens.get(at + 1).and_then(Token::word).map(str::to_owned);
                leaves.push((path, name));
                return at + 2;
            }
            Token::Word(word) if word == "self" && !path.is_empty() => {
                let name = path.last().cloned();
                leaves.push((path, name));
                return at + 1;
            }
            Token::Word(word) => path.push(word.clone()),
            Token::Path => {}
            Token::Sign('*') => {
                leaves.push((path, None));
                return at + 1;
            }
            Token::Sign('{') => return branches(tokens, at + 1, &path, leaves),
            Token::Sign(_) => break,
        }
        at += 1;
    }
    let name = path.last().cloned();
    leaves.push((path, name));
    at
}

fn branches(tokens: &[Token], mut at: usize, path: &[String], leaves: &mut Vec<Leaf>) -> usize {
    while at < tokens.len() && !tokens[at].is('}') {
        if tokens[at].is(',') {
            at += 1;
        } else {
            at = tree(tokens, at, path, leaves).max(at + 1);
        }
    }
    at + 1
}

/// Returns the words of a path in an expression or a type, and the position of its end.
fn plain_path(tokens: &[Token], start: usize) -> (Vec<String>, usize) {
    let mut words: Vec<String> = tokens[start].word().map(str::to_owned).into_iter().collect();
    let mut at = start + 1;
    while let (Some(Token::Path), Some(Token::Word(word))) = (tokens.get(at), tokens.get(at + 1)) {
        words.push(word.clone());
        at += 2;
    }
    (words, at)
}
