//! TOML with the line of every key and value, untyped.

use std::path::Path;

use toml::de::{DeTable, DeValue};

use crate::{Diagnostic, planning_scene_hint};

/// A value and its line (from 1).
#[derive(Debug, Clone)]
pub struct Node {
    /// The line.
    pub line: usize,
    /// The data.
    pub data: Data,
}

/// The data of a value.
#[derive(Debug, Clone)]
pub enum Data {
    /// A text.
    Text(String),
    /// A whole number or a number with a fraction; NaN and infinities too.
    Number(f64),
    /// True or false.
    Flag(bool),
    /// A date or time, which no file here uses.
    Date,
    /// A list.
    List(Vec<Node>),
    /// A table, in file order.
    Table(Vec<Entry>),
}

/// `key = value`, in file order.
#[derive(Debug, Clone)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Line of the key.
    pub line: usize,
    /// The value.
    pub node: Node,
}

impl Data {
    /// The type in words, for messages.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::Text(_) => "a text",
            Self::Number(_) => "a number",
            Self::Flag(_) => "true or false",
            Self::Date => "a date",
            Self::List(_) => "a list",
            Self::Table(_) => "a table",
        }
    }
}

/// Byte offsets of line starts.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Self {
        Self(std::iter::once(0).chain(text.bytes().enumerate().filter(|b| b.1 == b'\n').map(|b| b.0 + 1)).collect())
    }

    fn at(&self, offset: usize) -> usize {
        self.0.partition_point(|&start| start <= offset).max(1)
    }
}

/// Parses the text of a file.
///
/// # Errors
/// The text is not TOML, with the line and what to write instead.
pub fn parse(file: &Path, text: &str) -> Result<Vec<Entry>, Diagnostic> {
    let lines = Lines::of(text);
    match DeTable::parse(text) {
        Ok(table) => Ok(entries(&lines, table.get_ref())),
        Err(e) => {
            let line = e.span().map(|span| lines.at(span.start));
            let named = e.span().and_then(|span| text.get(span)).filter(|key| key.len() < 60 && !key.contains('\n'));
            let named = named.map_or_else(String::new, |key| format!(" `{key}`"));
            let what = format!("this is not TOML: {}{named}", e.message().trim().replace('\n', ", "));
            let hint = planning_scene_hint(file).unwrap_or_else(|| syntax_hint(e.message()).to_owned());
            Err(Diagnostic::new(file, line, what).hint(hint))
        }
    }
}

fn syntax_hint(message: &str) -> &'static str {
    if message.contains("duplicate key") {
        "each key and each [table] once; names of robots, objects and regions must differ"
    } else {
        "key = value, with texts in \"double quotes\", lists in [square brackets] and tables as [name] or { key = value }"
    }
}

fn entries(lines: &Lines, table: &DeTable<'_>) -> Vec<Entry> {
    let mut list: Vec<_> = table.iter().collect();
    list.sort_by_key(|(key, _)| key.span().start);
    list.into_iter()
        .map(|(key, value)| {
            let line = lines.at(key.span().start);
            Entry { key: key.get_ref().to_string(), line, node: node(lines, value.get_ref(), value.span().start, line) }
        })
        .collect()
}

fn node(lines: &Lines, value: &DeValue<'_>, offset: usize, key_line: usize) -> Node {
    let line = lines.at(offset).max(key_line);
    let data = match value {
        DeValue::String(text) => Data::Text(text.to_string()),
        DeValue::Integer(i) => Data::Number(integer(i.as_str(), i.radix())),
        DeValue::Float(f) => Data::Number(f.as_str().replace('_', "").parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(b) => Data::Flag(*b),
        DeValue::Datetime(_) => Data::Date,
        DeValue::Array(list) => {
            Data::List(list.iter().map(|v| node(lines, v.get_ref(), v.span().start, key_line)).collect())
        }
        DeValue::Table(table) => Data::Table(entries(lines, table)),
    };
    Node { line, data }
}

fn integer(digits: &str, radix: u32) -> f64 {
    let digits = digits.replace('_', "");
    i128::from_str_radix(&digits, radix).map_or_else(|_| digits.parse().unwrap_or(f64::NAN), |i| i as f64)
}
