//! A field of a document, with its path for messages.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::Arc;

use elbowroom_proximity::TriMesh;

use serde_json::Value;

use crate::{Diagnostic, yaml};

/// Largest joint value, rad or m. Poses computed from larger values would not be finite.
const MAX_JOINT_VALUE: f64 = 1e6;

/// The document of a field.
#[derive(Debug)]
pub(crate) struct Location<'a> {
    pub(crate) file: &'a Path,
    /// The part of the file, before the path in messages: ``set `A`, problem `B`: ``, or empty.
    pub(crate) part: String,
    /// Text of a YAML document, for line numbers.
    pub(crate) yaml: Option<&'a str>,
    /// Path of the root field in that document; empty for the document itself.
    pub(crate) yaml_path: String,
}

/// A value of the document, with its location.
#[derive(Debug, Clone)]
pub(crate) struct Field<'a> {
    pub(crate) location: &'a Location<'a>,
    /// Path in the document; empty for the document itself.
    path: String,
    value: &'a Value,
}

impl<'a> Field<'a> {
    pub(crate) fn root(location: &'a Location<'a>, value: &'a Value) -> Self {
        Self { location, path: String::new(), value }
    }

    /// Creates a diagnostic at this field.
    pub(crate) fn error(&self, what: impl std::fmt::Display, hint: impl Into<String>) -> Diagnostic {
        Diagnostic::new(self.location.file, self.line(), self.sentence(what)).hint(hint)
    }

    fn line(&self) -> Option<usize> {
        let root = &self.location.yaml_path;
        let dot = if root.is_empty() || self.path.is_empty() { "" } else { "." };
        let path = format!("{root}{dot}{}", self.path);
        self.location.yaml.map(|text| yaml::line_of(text, self.location.file, &path))
    }

    fn sentence(&self, what: impl std::fmt::Display) -> String {
        let path = if self.path.is_empty() { String::new() } else { format!("`{}` ", self.path) };
        format!("{}{path}{what}", self.location.part)
    }

    /// The field of an object; `None` if it is missing or null.
    pub(crate) fn get(&self, key: &str) -> Result<Option<Self>, Diagnostic> {
        let Value::Object(fields) = self.value else {
            return Err(self.error(format!("is {}", kind(self.value)), "an object: {\"NAME\": …}"));
        };
        let path = if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) };
        let value = fields.get(key).filter(|v| !v.is_null());
        Ok(value.map(|value| Self { location: self.location, path, value }))
    }

    /// A required field of an object.
    pub(crate) fn require(&self, key: &str, hint: &str) -> Result<Self, Diagnostic> {
        self.get(key)?.ok_or_else(|| self.error(format!("has no `{key}`"), hint))
    }

    pub(crate) fn is_list(&self) -> bool {
        self.value.is_array()
    }

    /// The elements of a list.
    pub(crate) fn elements(&self) -> Result<Vec<Self>, Diagnostic> {
        let Value::Array(values) = self.value else {
            return Err(self.error(format!("is {}", kind(self.value)), "a list: […]"));
        };
        let element = |(i, value)| Self { location: self.location, path: format!("{}[{i}]", self.path), value };
        Ok(values.iter().enumerate().map(element).collect())
    }

    /// The elements of a list in an object; empty if the list is missing.
    pub(crate) fn list(&self, key: &str) -> Result<Vec<Self>, Diagnostic> {
        self.get(key)?.map_or_else(|| Ok(Vec::new()), |field| field.elements())
    }

    /// Two lists of equal length, element by element.
    pub(crate) fn paired_lists(&self, keys: [&str; 2]) -> Result<Vec<(Self, Self)>, Diagnostic> {
        let [a, b] = [self.list(keys[0])?, self.list(keys[1])?];
        if a.len() != b.len() {
            let what = format!("has {} in `{}` and {} in `{}`", a.len(), keys[0], b.len(), keys[1]);
            return Err(self.error(what, "as many of the one as of the other"));
        }
        Ok(a.into_iter().zip(b).collect())
    }

    pub(crate) fn text(&self) -> Result<&'a str, Diagnostic> {
        self.value.as_str().ok_or_else(|| self.error(format!("is {}", kind(self.value)), "a text: \"…\""))
    }

    /// The text of a field of an object; empty if it is missing.
    pub(crate) fn text_of(&self, key: &str) -> Result<&'a str, Diagnostic> {
        self.get(key)?.map_or(Ok(""), |field| field.text())
    }

    /// A non-empty text.
    pub(crate) fn name(&self) -> Result<&'a str, Diagnostic> {
        Some(self.text()?).filter(|name| !name.is_empty()).ok_or_else(|| self.error("is empty", "a name"))
    }

    pub(crate) fn names(&self, key: &str) -> Result<Vec<String>, Diagnostic> {
        self.list(key)?.iter().map(|field| Ok(field.name()?.to_owned())).collect()
    }

    pub(crate) fn flag(&self) -> Result<bool, Diagnostic> {
        let word = || format!("is {}", kind(self.value));
        self.value.as_bool().or(self.value.as_u64().map(|n| n != 0)).ok_or_else(|| self.error(word(), "true or false"))
    }

    /// A finite number.
    pub(crate) fn number(&self) -> Result<f64, Diagnostic> {
        let number = self.value.as_f64().filter(|v| v.is_finite());
        number.ok_or_else(|| self.error(format!("is {}", kind(self.value)), "a finite number, as 0.25"))
    }

    /// The value of a joint, rad or m.
    pub(crate) fn joint_value(&self) -> Result<f64, Diagnostic> {
        let value = self.number()?;
        if value.abs() <= MAX_JOINT_VALUE {
            return Ok(value);
        }
        Err(self.error(format!("is {value}"), "radians, metres for a prismatic joint: 0.25"))
    }

    /// A whole number, 0 or more.
    pub(crate) fn index(&self) -> Result<u32, Diagnostic> {
        let index = self.value.as_u64().and_then(|n| u32::try_from(n).ok());
        index.ok_or_else(|| self.error(format!("is {}", kind(self.value)), "a whole number, 0 or more"))
    }

    /// A list of any number of numbers.
    pub(crate) fn numbers(&self) -> Result<Vec<f64>, Diagnostic> {
        self.elements()?.iter().map(Self::number).collect()
    }

    /// A fixed number of numbers: a list, or an object with these names.
    pub(crate) fn tuple<const N: usize>(&self, names: [&str; N]) -> Result<[f64; N], Diagnostic> {
        let hint = format!("[{}]", names.join(", "));
        let numbers = match self.value {
            Value::Object(_) => {
                let each = names.iter().map(|name| self.require(name, &hint)?.number());
                each.collect::<Result<Vec<_>, _>>()?
            }
            _ => self.numbers()?,
        };
        <[f64; N]>::try_from(numbers).map_err(|n| self.error(format!("has {} numbers, not {N}", n.len()), hint))
    }

    /// True for the given word or whole number; messages use numbers, files written by hand use words.
    pub(crate) fn is(&self, word: &str, number: u64) -> bool {
        self.value.as_str().is_some_and(|w| w.eq_ignore_ascii_case(word)) || self.value.as_u64() == Some(number)
    }

    /// The value for a message, shortened.
    pub(crate) fn shown(&self) -> String {
        match self.value {
            Value::String(_) | Value::Number(_) | Value::Bool(_) => self.value.to_string().chars().take(60).collect(),
            other => kind(other).to_owned(),
        }
    }
}

/// The kind of a value, for messages.
fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "true or false",
        Value::Number(_) => "a number",
        Value::String(_) => "a text",
        Value::Array(_) => "a list",
        Value::Object(_) => "an object",
    }
}

/// State of reading a document: its warnings and the mesh files that it names.
///
/// Each kind of warning is kept once, because a file may have thousands of problems of one kind.
#[derive(Debug, Default)]
pub(crate) struct Reading {
    seen: HashSet<&'static str>,
    pub(crate) warnings: Vec<Diagnostic>,
    /// Meshes by reference, as written, and scale.
    pub(crate) mesh_files: HashMap<(String, [u64; 3]), Arc<TriMesh>>,
}

impl Reading {
    /// Warns about the first case of a kind.
    pub(crate) fn once(&mut self, kind: &'static str, at: &Field<'_>, what: impl std::fmt::Display, hint: &str) {
        if self.seen.insert(kind) {
            self.warnings.push(at.error(format!("{what} (reported once)"), hint));
        }
    }
}
