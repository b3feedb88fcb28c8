//! Sizes of files, functions, structs and lists of dependencies. Unit tests at the end of a file do not count.

use std::collections::BTreeMap;

use toml::{Table, Value};

use super::files::SourceFile;
use super::measured::Measured;
use crate::functions::functions;
use crate::layers::source::{Token, before_tests, tokens};

/// The crate that a Rust user names.
const FACADE: &str = "elbowroom";

/// Counts the lines of each file.
pub fn lines_of_files(files: &[SourceFile]) -> Vec<Measured> {
    let measured = files.iter().filter(|file| file.is_measured);
    let size = |file: &SourceFile| Measured {
        name: file.path.clone(),
        place: format!("{}:1", file.path),
        value: before_tests(&file.text).lines().count(),
    };
    measured.map(size).collect()
}

/// Counts the lines of each function.
pub fn lines_of_functions(files: &[SourceFile]) -> Vec<Measured> {
    each_file(files, |file| {
        let found = functions(before_tests(&file.text));
        found.into_iter().map(|f| (f.name.to_owned(), f.line, f.lines)).collect()
    })
}

/// Counts the fields of each struct.
pub fn fields_of_structs(files: &[SourceFile]) -> Vec<Measured> {
    each_file(files, |file| {
        let structs = structs(&tokens(&file.text)).into_iter();
        structs.map(|(name, fields)| (name.clone(), line_of(&file.text, &format!("struct {name}")), fields)).collect()
    })
}

/// Counts the direct dependencies of each crate (name → its `Cargo.toml`), inside and outside the workspace, without
/// those of tests. The façade exports every crate: it has no limit.
pub fn dependencies_of_crates(manifests: &BTreeMap<String, Table>) -> Vec<Measured> {
    let count = |manifest: &Table| manifest.get("dependencies").and_then(Value::as_table).map_or(0, Table::len);
    let size = |(name, manifest): (&String, &Table)| Measured {
        name: name.clone(),
        place: format!("Cargo.toml of {name}"),
        value: count(manifest),
    };
    manifests.iter().filter(|(name, _)| *name != FACADE).map(size).collect()
}

/// Returns the line, from 1, on which these words occur for the first time.
pub fn line_of(text: &str, words: &str) -> usize {
    let is_end = |line: &str, at: usize| {
        line[at + words.len()..].chars().next().is_none_or(|c| !c.is_alphanumeric() && c != '_')
    };
    let found = text.lines().position(|line| line.match_indices(words).any(|(at, _)| is_end(line, at)));
    found.map_or(1, |line| line + 1)
}

/// Collects names, lines and sizes in each file. If a name occurs twice in a file, the second gets ` (2)`, so that
/// names are unique.
fn each_file(files: &[SourceFile], measure: impl Fn(&SourceFile) -> Vec<(String, usize, usize)>) -> Vec<Measured> {
    let mut found = Vec::new();
    for file in files.iter().filter(|file| file.is_measured) {
        let mut seen = BTreeMap::new();
        for (name, line, value) in measure(file) {
            let count = seen.entry(name.clone()).and_modify(|n| *n += 1).or_insert(1);
            let number = if *count > 1 { format!(" ({count})") } else { String::new() };
            let (name, place) = (format!("{}: {name}{number}", file.path), format!("{}:{line}", file.path));
            found.push(Measured { name, place, value });
        }
    }
    found
}

/// Returns the names of structs and the numbers of their fields.
fn structs(tokens: &[Token]) -> Vec<(String, usize)> {
    let mut found = Vec::new();
    for (i, token) in tokens.iter().enumerate() {
        let (Some("struct"), Some(name)) = (token.word(), tokens.get(i + 1).and_then(Token::word)) else { continue };
        let body = &tokens[i + 2..];
        // A `(` before the brace belongs to a tuple struct, or to a bound of its parameters.
        let Some(start) = body.iter().position(|t| t.is('{') || t.is('(') || t.is(';')) else { continue };
        let fields = if body[start].is('{') {
            named_fields(&body[start + 1..])
        } else if body[start].is('(') {
            unnamed_fields(&body[start + 1..])
        } else {
            0
        };
        found.push((name.to_owned(), fields));
    }
    found
}

/// Counts fields up to the closing brace: a word and a colon, outside all brackets.
fn named_fields(body: &[Token]) -> usize {
    let is_field = |i: usize| body[i].is(':') && i > 0 && body[i - 1].word().is_some();
    outside_brackets(body).into_iter().filter(|&i| is_field(i)).count()
}

/// Counts types up to the closing parenthesis, separated by commas.
fn unnamed_fields(body: &[Token]) -> usize {
    let outside = outside_brackets(body);
    let Some(last) = outside.last() else { return 0 };
    outside.iter().filter(|&&i| body[i].is(',')).count() + usize::from(!body[*last].is(','))
}

/// Returns the positions up to the bracket that closes `body`, without those inside further brackets.
fn outside_brackets(body: &[Token]) -> Vec<usize> {
    let (mut depth, mut outside) = (0_usize, Vec::new());
    for (i, token) in body.iter().enumerate() {
        let is_arrow = token.is('>') && i > 0 && body[i - 1].is('-');
        match token {
            Token::Sign('{' | '(' | '[' | '<') => depth += 1,
            Token::Sign('}' | ')' | ']' | '>') if !is_arrow => {
                if depth == 0 {
                    break;
                }
                depth -= 1;
            }
            _ if depth == 0 => outside.push(i),
            _ => {}
        }
    }
    outside
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> [SourceFile; 1] {
        [SourceFile { path: "a.rs".into(), text: text.into(), is_measured: true }]
    }

    fn sizes(found: &[Measured]) -> Vec<(&str, &str, usize)> {
        found.iter().map(|m| (m.name.as_str(), m.place.as_str(), m.value)).collect()
    }

    const TESTS: &str = "#[cfg(test)]\nmod tests {\n    fn b() {\n    }\n    struct B { a: u8 }\n}\n";

    #[test]
    fn unit_tests_do_not_count() {
        let text = format!("fn a() {{\n}}\n{TESTS}");
        assert_eq!(sizes(&lines_of_files(&file(&text))), [("a.rs", "a.rs:1", 2)]);
        assert_eq!(sizes(&lines_of_functions(&file(&text))), [("a.rs: a", "a.rs:1", 2)]);
        assert!(fields_of_structs(&file(&text)).is_empty());
    }

    #[test]
    fn test_files_are_not_measured() {
        let [test] = file("fn a() {\n}\n");
        assert!(lines_of_files(&[SourceFile { is_measured: false, ..test }]).is_empty());
    }

    #[test]
    fn functions_of_equal_names_are_listed_apart() {
        let text = "impl A {\n    fn new() {\n    }\n}\nimpl B {\n    fn new() {\n\n    }\n}\n";
        let found = lines_of_functions(&file(text));
        assert_eq!(sizes(&found), [("a.rs: new", "a.rs:2", 2), ("a.rs: new (2)", "a.rs:6", 3)]);
    }

    #[test]
    fn fields_are_counted_in_every_kind_of_struct() {
        let text = "struct Named<T: Copy> {\n    /// One: the first.\n    #[serde(default = \"x\", with = \"a::b\")]\n    pub one: Vec<(u8, T)>,\n    \
            two: fn(a: u8) -> Map<String, u8>,\n    three: [u8; 3],\n}\npub struct Two(pub Map<u8, u8>, u8);\nstruct None;\nstruct One(\n    u8,\n);\n";
        let found = fields_of_structs(&file(text));
        let expected = [
            ("a.rs: Named", "a.rs:1", 3),
            ("a.rs: Two", "a.rs:8", 2),
            ("a.rs: None", "a.rs:9", 0),
            ("a.rs: One", "a.rs:10", 1),
        ];
        assert_eq!(sizes(&found), expected);
    }

    #[test]
    fn dependencies_of_tests_do_not_count() {
        let manifest: Table =
            "[dependencies]\na = \"1\"\nb.workspace = true\n[dev-dependencies]\nc = \"1\"".parse().unwrap();
        let crates = ["cell", FACADE].map(|name| (name.to_owned(), manifest.clone()));
        let found = dependencies_of_crates(&BTreeMap::from(crates));
        assert_eq!(sizes(&found), [("cell", "Cargo.toml of cell", 2)]);
    }
}
