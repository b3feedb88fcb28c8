//! Typed access to the nodes, with instructive errors.

use std::fmt::Display;
use std::path::Path;

use elbowroom_spatial::Vec3;

use super::node::{Data, Entry, Node};
use crate::{Diagnostic, suggest};

type Result<T> = std::result::Result<T, Diagnostic>;

/// A table of the file and its full name: `robot.ns16.tool`.
#[derive(Debug, Clone)]
pub struct Table<'a> {
    /// The file, for messages.
    pub file: &'a Path,
    /// The full name; empty for the whole file.
    pub name: String,
    /// The line.
    pub line: usize,
    /// The keys and values, in file order.
    pub entries: &'a [Entry],
}

/// A value of the file and its full name.
#[derive(Debug, Clone)]
pub struct Value<'a> {
    /// The file, for messages.
    pub file: &'a Path,
    /// The full name.
    pub name: String,
    /// The line.
    pub line: usize,
    /// The value itself.
    pub node: &'a Node,
}

impl<'a> Table<'a> {
    /// An error at the line of the table.
    pub fn error(&self, what: impl Display) -> Diagnostic {
        Diagnostic::new(self.file, self.line, what)
    }

    fn full_name(&self, key: &str) -> String {
        if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) }
    }

    fn display_name(&self) -> String {
        if self.name.is_empty() { "the file".into() } else { format!("`{}`", self.name) }
    }

    fn value(&self, entry: &'a Entry) -> Value<'a> {
        Value { file: self.file, name: self.full_name(&entry.key), line: entry.node.line, node: &entry.node }
    }

    /// Refuses keys that are not in `known`.
    ///
    /// # Errors
    /// The first other key, with the nearest known one.
    pub fn only(&self, known: &[&str]) -> Result<()> {
        let Some(entry) = self.entries.iter().find(|e| !known.contains(&e.key.as_str())) else { return Ok(()) };
        let what = format!("{} has no key `{}`", self.display_name(), entry.key);
        let hint = suggest::hint(&entry.key, known.iter().copied());
        Err(Diagnostic::new(self.file, entry.line, what).hint(hint))
    }

    /// The value of a key, if the table has it.
    pub fn get(&self, key: &str) -> Option<Value<'a>> {
        self.entries.iter().find(|e| e.key == key).map(|e| self.value(e))
    }

    /// The value of a required key; `example` is what to write.
    ///
    /// # Errors
    /// The table does not have the key.
    pub fn need(&self, key: &str, example: &str) -> Result<Value<'a>> {
        self.get(key).ok_or_else(|| self.error(format!("{} needs the key `{key}`", self.display_name())).hint(example))
    }

    /// The keys and values in file order.
    pub fn each(&self) -> impl Iterator<Item = (&'a str, Value<'a>)> + '_ {
        self.entries.iter().map(|e| (e.key.as_str(), self.value(e)))
    }

    /// The tables `[key.NAME]` in file order.
    ///
    /// # Errors
    /// Another type, or a name that files of results cannot have.
    pub fn named(&self, key: &str) -> Result<Vec<(&'a str, Table<'a>)>> {
        let Some(group) = self.get(key) else { return Ok(Vec::new()) };
        let group = group.table(&format!("[{key}.NAME]"))?;
        let named: Vec<_> = group.entries.iter().map(|e| (e, group.value(e))).collect();
        named
            .into_iter()
            .map(|(e, v)| {
                if e.key.trim().is_empty() || e.key.contains(['/', ',', '"', '\n', '\r']) {
                    let what = format!("`{}` is not a name for a {key}", e.key.escape_debug());
                    return Err(Diagnostic::new(v.file, e.line, what)
                        .hint("a name without slash, comma, quote and line break, because it appears in CSV files"));
                }
                Ok((e.key.as_str(), v.table(&format!("[{key}.{}]", e.key))?.at_line(e.line)))
            })
            .collect()
    }

    /// The table, with another line in its messages.
    #[must_use]
    pub fn at_line(mut self, line: usize) -> Self {
        self.line = line;
        self
    }

    /// True or false; the default without the key.
    ///
    /// # Errors
    /// Another type.
    pub fn flag_or(&self, key: &str, default: bool) -> Result<bool> {
        self.get(key).map_or(Ok(default), |v| v.flag())
    }
}

impl<'a> Value<'a> {
    /// An error at the line of the value, about its key.
    pub fn error(&self, what: impl Display) -> Diagnostic {
        Diagnostic::new(self.file, self.line, format!("`{}` {what}", self.name))
    }

    fn wrong_type(&self, wanted: &str, example: &str) -> Diagnostic {
        self.error(format!("must be {wanted}, not {}", self.node.data.type_name())).hint(example)
    }

    /// The last part of the full name.
    pub fn key(&self) -> &str {
        self.name.rsplit('.').next().unwrap_or(&self.name)
    }

    /// A finite number.
    ///
    /// # Errors
    /// Another type or number.
    pub fn number(&self) -> Result<f64> {
        match self.node.data {
            Data::Number(v) if v.is_finite() => Ok(v),
            Data::Number(v) => Err(self.error(format!("is {v}")).hint(format!("{} = a finite number", self.key()))),
            _ => Err(self.wrong_type("a number", &format!("{} = 100", self.key()))),
        }
    }

    /// A finite number above 0.
    ///
    /// # Errors
    /// Another type or number.
    pub fn positive(&self) -> Result<f64> {
        let v = self.number()?;
        let more = || format!("{} = a number above 0", self.key());
        if v > 0.0 { Ok(v) } else { Err(self.error(format!("must be above 0, not {v}")).hint(more())) }
    }

    /// A finite number, 0 or more.
    ///
    /// # Errors
    /// Another type or number.
    pub fn not_negative(&self) -> Result<f64> {
        let v = self.number()?;
        let more = || format!("{} = 0 or a number above it", self.key());
        if v >= 0.0 { Ok(v) } else { Err(self.error(format!("must be 0 or more, not {v}")).hint(more())) }
    }

    /// A percentage from 0 to 100, as a fraction.
    ///
    /// # Errors
    /// Another type or number.
    pub fn percent(&self) -> Result<f64> {
        let v = self.number()?;
        if (0.0..=100.0).contains(&v) {
            return Ok(v / 100.0);
        }
        Err(self.error(format!("is a percentage: 0 to 100, not {v}")).hint(format!("{} = 50", self.key())))
    }

    /// A whole number within limits.
    ///
    /// # Errors
    /// Another type or number.
    pub fn whole(&self, least: u32, most: u32) -> Result<u32> {
        let v = self.number()?;
        if v.fract() == 0.0 && (f64::from(least)..=f64::from(most)).contains(&v) {
            return Ok(v as u32);
        }
        let what = format!("must be a whole number from {least} to {most}, not {v}");
        Err(self.error(what).hint(format!("{} = {least}", self.key())))
    }

    /// A text.
    ///
    /// # Errors
    /// Another type.
    pub fn text(&self) -> Result<&'a str> {
        match &self.node.data {
            Data::Text(t) => Ok(t),
            _ => Err(self.wrong_type("a text in quotes", &format!("{} = \"…\"", self.key()))),
        }
    }

    /// True or false.
    ///
    /// # Errors
    /// Another type.
    pub fn flag(&self) -> Result<bool> {
        match self.node.data {
            Data::Flag(b) => Ok(b),
            _ => Err(self.wrong_type("true or false", &format!("{} = true", self.key()))),
        }
    }

    /// One of a set of words.
    ///
    /// # Errors
    /// Another type or word, with the nearest known one.
    pub fn word<T: Copy>(&self, words: &[(&str, T)]) -> Result<T> {
        let list = || words.iter().map(|w| w.0);
        let Data::Text(text) = &self.node.data else {
            return Err(self.wrong_type(
                &format!("one of {}", suggest::quoted(list())),
                &format!("{} = \"{}\"", self.key(), words.first().map_or("…", |w| w.0)),
            ));
        };
        words
            .iter()
            .find(|w| w.0 == text)
            .map(|w| w.1)
            .ok_or_else(|| self.error(format!("cannot be \"{text}\"")).hint(suggest::hint(text, list())))
    }

    /// Whether the value is a list.
    pub fn is_list(&self) -> bool {
        matches!(self.node.data, Data::List(_))
    }

    /// Whether the value is a table.
    pub fn is_table(&self) -> bool {
        matches!(self.node.data, Data::Table(_))
    }

    /// Whether the value is a number.
    pub fn is_number(&self) -> bool {
        matches!(self.node.data, Data::Number(_))
    }

    /// The values of a list; `example` is what to write.
    ///
    /// # Errors
    /// Another type.
    pub fn list(&self, example: &str) -> Result<Vec<Value<'a>>> {
        let Data::List(nodes) = &self.node.data else { return Err(self.wrong_type("a list", example)) };
        let item = |(i, node): (usize, &'a Node)| Value {
            file: self.file,
            name: format!("{}[{i}]", self.name),
            line: node.line,
            node,
        };
        Ok(nodes.iter().enumerate().map(item).collect())
    }

    /// The finite numbers of a list; `example` is what to write.
    ///
    /// # Errors
    /// Another type.
    pub fn numbers(&self, example: &str) -> Result<Vec<f64>> {
        self.list(example)?.iter().map(Value::number).collect()
    }

    /// Three numbers, without unit.
    ///
    /// # Errors
    /// Another type or number of numbers.
    pub fn three(&self) -> Result<Vec3> {
        let example = format!("{} = [0, 0, 0]", self.key());
        let v = self.numbers(&example)?;
        <[f64; 3]>::try_from(v.as_slice())
            .map(Vec3::from)
            .map_err(|_| self.error(format!("needs 3 numbers, not {}", v.len())).hint(example))
    }

    /// A table; `example` is what to write.
    ///
    /// # Errors
    /// Another type.
    pub fn table(&self, example: &str) -> Result<Table<'a>> {
        let Data::Table(entries) = &self.node.data else { return Err(self.wrong_type("a table", example)) };
        Ok(Table { file: self.file, name: self.name.clone(), line: self.line, entries })
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;

    #[test]
    fn errors_of_the_whole_file_name_the_file_and_not_its_kind() {
        let entries = parse("key.toml".as_ref(), "secert = \"00\"\n").unwrap();
        let file = Table { file: "key.toml".as_ref(), name: String::new(), line: 1, entries: &entries };
        let unknown = file.only(&["secret"]).unwrap_err().to_string();
        assert!(
            unknown.contains("key.toml:1: the file has no key `secert`") && unknown.contains("secret"),
            "{unknown}"
        );
        let missing = file.need("secret", "secret = \"…\"").unwrap_err().to_string();
        assert!(missing.contains("the file needs the key `secret`"), "{missing}");
    }
}
