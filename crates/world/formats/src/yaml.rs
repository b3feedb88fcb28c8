//! YAML documents as values of JSON, and the lines of their fields.

use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use saphyr_parser::{Event, Parser, ScalarStyle, ScanError, Tag};
use serde_json::{Map, Number, Value};

use crate::Diagnostic;
use crate::tokens::show;

/// Largest depth of nested lists and mappings.
const MAX_DEPTH: usize = 100;
/// Number of values with anchors, and of their copies, that a short file may have.
///
/// A long file may have as many as it has bytes.
const MIN_COPIED: usize = 1000;

/// Parses the first document of a text.
///
/// # Errors
/// [`Diagnostic`] for text that is not YAML, keys that are not text or occur twice, merge keys, or aliases that repeat
/// more than the file has.
pub(crate) fn parse(text: &str, file: &Path) -> Result<Value, Diagnostic> {
    Builder::new(text, file).build(&mut |_, _| {})
}

/// The line of the field with a path such as `world.objects[2].id`, or of the part of the path that exists.
pub(crate) fn line_of(text: &str, file: &Path, path: &str) -> usize {
    let mut found = (0, 1);
    // If a later part of the document is invalid, the part before it has been visited.
    drop(Builder::new(text, file).build(&mut |open, line| {
        let here = path_of(open);
        let is_above = path
            .strip_prefix(&here[..])
            .is_some_and(|rest| here.is_empty() || rest.is_empty() || rest.starts_with(['.', '[']));
        if is_above && here.len() >= found.0 {
            found = (here.len(), line);
        }
    }));
    found.1
}

/// The path of the next value.
fn path_of(open: &[Open]) -> String {
    let mut path = String::new();
    for Open { container, .. } in open {
        match container {
            // Writing to a String cannot fail.
            Container::List(list) => {
                let _ = write!(path, "[{}]", list.len());
            }
            Container::Mapping(_, key) => {
                if !path.is_empty() {
                    path.push('.');
                }
                path += key.as_deref().unwrap_or_default();
            }
        }
    }
    path
}

/// A list or mapping whose end is not reached yet.
struct Open {
    container: Container,
    /// Number of its anchor; 0 without an anchor.
    anchor: usize,
}

enum Container {
    List(Vec<Value>),
    /// A mapping, and the key of the next value.
    Mapping(Map<String, Value>, Option<String>),
}

struct Builder<'t> {
    file: &'t Path,
    text: &'t str,
    open: Vec<Open>,
    anchored: HashMap<usize, Value>,
    copied: usize,
    root: Option<Value>,
}

impl<'t> Builder<'t> {
    fn new(text: &'t str, file: &'t Path) -> Self {
        Self { file, text, open: Vec::new(), anchored: HashMap::new(), copied: 0, root: None }
    }

    /// Builds the document. Calls `visit` before each value with the open containers and the line of the value.
    fn build(mut self, visit: &mut dyn FnMut(&[Open], usize)) -> Result<Value, Diagnostic> {
        for event in Parser::new_from_str(self.text) {
            let (event, span) = event.map_err(|e| self.no_yaml(&e))?;
            let line = span.start.line();
            let is_key = matches!(self.open.last(), Some(Open { container: Container::Mapping(_, None), .. }));
            match event {
                Event::Scalar(text, _, _, _) if is_key => self.key(&text, line)?,
                Event::Alias(_) | Event::SequenceStart(..) | Event::MappingStart(..) if is_key => {
                    return Err(self.error(line, "has a key that is no text", "NAME: value"));
                }
                Event::Scalar(text, style, anchor, tag) => {
                    visit(&self.open, line);
                    self.value(scalar(&text, style, tag.as_deref()), anchor, line)?;
                }
                Event::Alias(anchor) => {
                    visit(&self.open, line);
                    let value = self.repeat(anchor, line)?;
                    self.value(value, 0, line)?;
                }
                Event::SequenceStart(anchor, _) => {
                    visit(&self.open, line);
                    self.open(Container::List(Vec::new()), anchor, line)?;
                }
                Event::MappingStart(anchor, _) => {
                    visit(&self.open, line);
                    self.open(Container::Mapping(Map::new(), None), anchor, line)?;
                }
                Event::SequenceEnd | Event::MappingEnd => {
                    if let Some(Open { container, anchor }) = self.open.pop() {
                        let value = match container {
                            Container::List(list) => Value::Array(list),
                            Container::Mapping(map, _) => Value::Object(map),
                        };
                        self.value(value, anchor, line)?;
                    }
                }
                Event::DocumentEnd => break,
                _ => {}
            }
        }
        let root = self.root.take();
        root.ok_or_else(|| self.error(1, "has no document", "KEY: VALUE"))
    }

    fn error(&self, line: usize, what: &str, hint: &str) -> Diagnostic {
        Diagnostic::new(self.file, line, what).hint(hint)
    }

    fn no_yaml(&self, e: &ScanError) -> Diagnostic {
        let what = format!("is not YAML: {}", e.info());
        self.error(e.marker().line(), &what, "YAML: spaces, not tabs, before a key, and a space behind its colon")
    }

    fn key(&mut self, text: &str, line: usize) -> Result<(), Diagnostic> {
        if text == "<<" {
            return Err(self.error(line, "has a merge key `<<`, which is not read", "the keys themselves"));
        }
        let Some(Open { container: Container::Mapping(map, key), .. }) = self.open.last_mut() else { return Ok(()) };
        if map.contains_key(text) {
            let what = format!("the key `{}` occurs twice", show(text.as_bytes()));
            return Err(self.error(line, &what, "each key once"));
        }
        *key = Some(text.to_owned());
        Ok(())
    }

    fn open(&mut self, container: Container, anchor: usize, line: usize) -> Result<(), Diagnostic> {
        self.check_depth(self.open.len() + 1, line)?;
        self.open.push(Open { container, anchor });
        Ok(())
    }

    fn check_depth(&self, depth: usize, line: usize) -> Result<(), Diagnostic> {
        if depth <= MAX_DEPTH {
            return Ok(());
        }
        Err(self.error(line, &format!("has more than {MAX_DEPTH} lists and mappings in each other"), "fewer levels"))
    }

    /// Copies an anchored value.
    fn repeat(&mut self, anchor: usize, line: usize) -> Result<Value, Diagnostic> {
        let Some(value) = self.anchored.get(&anchor) else {
            return Err(self.error(line, "has an alias within its own value", "a value that ends before its alias"));
        };
        let (value, (count, depth)) = (value.clone(), extent(value));
        self.check_depth(self.open.len() + depth, line)?;
        self.count_copies(count, line)?;
        Ok(value)
    }

    /// Refuses copies of more values than the text has bytes.
    fn count_copies(&mut self, count: usize, line: usize) -> Result<(), Diagnostic> {
        self.copied += count;
        if self.copied <= self.text.len().max(MIN_COPIED) {
            return Ok(());
        }
        let hint = "the values themselves, without anchors (&) and aliases (*)";
        Err(self.error(line, "has aliases that repeat more than the file has", hint))
    }

    /// Adds a value to its container.
    fn value(&mut self, value: Value, anchor: usize, line: usize) -> Result<(), Diagnostic> {
        if anchor > 0 {
            self.count_copies(extent(&value).0, line)?;
            self.anchored.insert(anchor, value.clone());
        }
        match self.open.last_mut().map(|o| &mut o.container) {
            Some(Container::List(list)) => list.push(value),
            Some(Container::Mapping(map, key)) => drop(map.insert(key.take().unwrap_or_default(), value)),
            None => self.root = Some(value),
        }
        Ok(())
    }
}

/// Number of values in a value, including itself, and number of levels.
fn extent(value: &Value) -> (usize, usize) {
    let all = |(count, depth): (usize, usize), v: &Value| {
        let (n, d) = extent(v);
        (count + n, depth.max(d + 1))
    };
    match value {
        Value::Array(list) => list.iter().fold((1, 1), all),
        Value::Object(map) => map.values().fold((1, 1), all),
        _ => (1, 0),
    }
}

/// Parses a scalar by the core schema. A byte of `!!binary` becomes its number.
fn scalar(text: &str, style: ScalarStyle, tag: Option<&Tag>) -> Value {
    match tag.filter(|t| t.is_yaml_core_schema()).map(|t| &t.suffix[..]) {
        Some("str") => return Value::from(text),
        Some("binary") => {
            let bytes = BASE64_STANDARD.decode(text.trim()).unwrap_or_default();
            return if let [byte] = bytes[..] { Value::from(byte) } else { Value::from(text) };
        }
        _ => {}
    }
    if style != ScalarStyle::Plain {
        return Value::from(text);
    }
    match text {
        "" | "~" | "null" | "Null" | "NULL" => Value::Null,
        "true" | "True" | "TRUE" => Value::Bool(true),
        "false" | "False" | "FALSE" => Value::Bool(false),
        _ => number(text).map_or_else(|| Value::from(text), Value::Number),
    }
}

/// Parses a finite number.
fn number(text: &str) -> Option<Number> {
    if let Ok(whole) = text.parse::<i64>() {
        return Some(Number::from(whole));
    }
    if let Some(digits) = text.strip_prefix("0x") {
        return i64::from_str_radix(digits, 16).ok().map(Number::from);
    }
    // Not the `inf` and `nan` of the standard library.
    let is_number = text.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
    text.parse().ok().filter(|_| is_number).and_then(Number::from_f64)
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn read(text: &str) -> Result<Value, Diagnostic> {
        parse(text, Path::new("a.yaml"))
    }

    #[test]
    fn scalars_follow_the_core_schema() {
        let text = "a: [1, -2.5, 0., .5, 1e3, 0x10, ~, , true, no, \"3\", '4', .inf, .nan, 1_0, inf]\n\
                    b: !!str 7\nc: !!binary AQ==\nd: |\n  two\n  lines\n";
        let a = json!([1, -2.5, 0.0, 0.5, 1e3, 16, null, null, true, "no", "3", "4", ".inf", ".nan", "1_0", "inf"]);
        let Ok(Value::Object(map)) = read(&text.replace(", ,", ", null,")) else { panic!() };
        assert_eq!(map["a"], a);
        assert_eq!((&map["b"], &map["c"], &map["d"]), (&json!("7"), &json!(1), &json!("two\nlines\n")));
    }

    #[test]
    fn anchors_are_copied_within_bounds() {
        assert_eq!(read("a: &x {b: [1]}\nc: *x\n").unwrap(), json!({"a": {"b": [1]}, "c": {"b": [1]}}));
        let mut bomb = String::from("a0: &a0 [x, x, x, x, x, x, x, x, x]\n");
        for i in 1..9 {
            writeln!(bomb, "a{i}: &a{i} [{}]", vec![format!("*a{}", i - 1); 9].join(", ")).unwrap();
        }
        assert!(read(&bomb).unwrap_err().message.contains("aliases that repeat"));
        assert!(read("a: &x [*x]\n").unwrap_err().message.contains("within its own value"));
    }

    #[test]
    fn what_is_no_document_is_refused_with_its_line() {
        let deep = (0..150).map(|i| " ".repeat(i) + "a:").collect::<Vec<_>>().join("\n");
        let cases = [
            ("a: 1\nb: [1, 2\nc: 3\n", "not YAML"),
            ("a: 1\na: 2\n", "`a` occurs twice"),
            ("? [1]\n: 2\n", "key that is no text"),
            ("a: &x {b: 1}\nc:\n  <<: *x\n", "merge key"),
            ("# nothing\n", "no document"),
            (&deep, "100 lists"),
        ];
        for (text, what) in cases {
            let e = read(text).expect_err(text);
            assert!(e.message.contains(what) && e.line.is_some() && e.hint.is_some(), "{text}: {e}");
        }
        assert_eq!(read("a: 1\na: 2\n").unwrap_err().line, Some(2));
    }

    #[test]
    fn fields_have_lines() {
        let text = "a:\n  - b: 1\n    c: 2\n  - b: 3\n    d:\n      - 4\n      - 5\nab: 6\n";
        let line = |path: &str| line_of(text, Path::new("a.yaml"), path);
        let lines = ["a[0].c", "a[1].b", "a[1].d[1]", "a[1].e", "ab", "zzz", ""].map(line);
        assert_eq!(lines, [3, 4, 7, 4, 8, 1, 1]);
    }
}
