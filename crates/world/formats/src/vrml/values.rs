//! Values of fields as numbers, booleans and texts, with the line of every fault.

use std::path::Path;

use elbowroom_spatial::Vec3;

use super::document::{Field, Node, Value};
use super::lexer::{Lexer, Token, unescaped};
use crate::Diagnostic;
use crate::tokens::{integer, number, show};

type Result<T> = std::result::Result<T, Diagnostic>;

/// Longest text of a value with a fixed number of parts, bytes: it may be parsed again for every `USE`.
const MAX_FIXED: usize = 4096;

/// Reads the fields of a node.
#[derive(Clone, Copy)]
pub(super) struct Fields<'a, 'w> {
    pub(super) node: &'a Node<'a>,
    pub(super) file: &'w Path,
}

impl<'a> Fields<'a, '_> {
    /// A diagnostic at the line of the node.
    pub(super) fn error(&self, what: impl std::fmt::Display) -> Diagnostic {
        Diagnostic::new(self.file, self.node.line, format!("{}: {what}", show(self.node.kind)))
    }

    /// The words of a field with their lines; none if the field is missing or `NULL`.
    pub(super) fn words(&self, name: &str) -> Result<Words<'a>> {
        match self.node.field(name) {
            None => Ok(Words(Lexer::at_line(b"", self.node.line))),
            Some(Field { value: Value::Plain { text, line }, .. }) => Ok(Words(Lexer::at_line(text, *line))),
            Some(Field { value: Value::Nodes(nodes), line, .. }) if nodes.is_empty() => {
                Ok(Words(Lexer::at_line(b"", *line)))
            }
            Some(Field { line, .. }) => {
                let what = format!("{} of {} is a node", show(name.as_bytes()), show(self.node.kind));
                Err(Diagnostic::new(self.file, *line, what).hint("numbers, TRUE or FALSE, or texts in quotes"))
            }
        }
    }

    /// A field of exactly `N` finite numbers; `default` if it is missing.
    pub(super) fn tuple<const N: usize>(&self, name: &str, default: [f64; N]) -> Result<[f64; N]> {
        let mut tuple = default;
        if !self.is_set(name)? {
            return Ok(tuple);
        }
        let mut words = self.words(name)?;
        for part in &mut tuple {
            let (word, line) = words.next().ok_or_else(|| self.wrong_count(name, N))?;
            *part = finite(word, line, name, self.file)?;
        }
        if words.next().is_some() {
            return Err(self.wrong_count(name, N));
        }
        Ok(tuple)
    }

    fn wrong_count(&self, name: &str, count: usize) -> Diagnostic {
        let line = self.node.field(name).map_or(self.node.line, |f| f.line);
        let numbers = if count == 1 { "1 number".to_owned() } else { format!("{count} numbers") };
        let what = format!("{name} of {} is not made of {numbers}", show(self.node.kind));
        Diagnostic::new(self.file, line, what).hint(format!("{numbers} behind {name}"))
    }

    /// Whether a field of a fixed number of parts is there.
    fn is_set(&self, name: &str) -> Result<bool> {
        match self.node.field(name) {
            None => Ok(false),
            Some(Field { value: Value::Plain { text, .. }, line, .. }) if text.len() > MAX_FIXED => {
                let what = format!("{name} of {} is a text of {} bytes", show(self.node.kind), text.len());
                Err(Diagnostic::new(self.file, *line, what).hint("one value, without a long comment in it"))
            }
            Some(_) => Ok(true),
        }
    }

    /// A length that must be above zero.
    pub(super) fn length(&self, name: &str, default: f64) -> Result<f64> {
        let [length] = self.tuple(name, [default])?;
        if length > 0.0 {
            return Ok(length);
        }
        let line = self.node.field(name).map_or(self.node.line, |f| f.line);
        let what = format!("{name} of {} is {length}", show(self.node.kind));
        Err(Diagnostic::new(self.file, line, what).hint("a length above 0, in metres"))
    }

    /// `TRUE` or `FALSE`.
    pub(super) fn boolean(&self, name: &str, default: bool) -> Result<bool> {
        if !self.is_set(name)? {
            return Ok(default);
        }
        let mut words = self.words(name)?;
        match (words.next(), words.next()) {
            (Some((b"TRUE", _)), None) => Ok(true),
            (Some((b"FALSE", _)), None) => Ok(false),
            _ => {
                let line = self.node.field(name).map_or(self.node.line, |f| f.line);
                let what = format!("{name} of {} is neither TRUE nor FALSE", show(self.node.kind));
                Err(Diagnostic::new(self.file, line, what).hint(format!("{name} TRUE")))
            }
        }
    }

    /// An integer.
    pub(super) fn integer(&self, name: &str, default: i64) -> Result<i64> {
        if !self.is_set(name)? {
            return Ok(default);
        }
        let mut words = self.words(name)?;
        match (words.next().and_then(|(word, _)| integer(word)), words.next()) {
            (Some(value), None) => Ok(value),
            _ => Err(self.wrong_count(name, 1).hint("an integer")),
        }
    }

    /// Finite numbers of a list.
    pub(super) fn numbers(&self, name: &str) -> Result<Vec<f64>> {
        self.words(name)?.map(|(word, line)| finite(word, line, name, self.file)).collect()
    }

    /// Points of a list.
    pub(super) fn points(&self, name: &str) -> Result<Vec<Vec3>> {
        let numbers = self.numbers(name)?;
        let (points, rest) = numbers.as_chunks::<3>();
        if !rest.is_empty() {
            let what = format!("{name} has {} numbers, which are not three per point", numbers.len());
            return Err(self.error(what).hint("x y z for every point"));
        }
        Ok(points.iter().copied().map(Vec3::from).collect())
    }

    /// Texts of a list.
    pub(super) fn texts(&self, name: &str) -> Result<Vec<String>> {
        let Some(Field { value: Value::Plain { text, line }, .. }) = self.node.field(name) else {
            return Ok(Vec::new());
        };
        let unquoted = |token| match token {
            Token::Text(text) => Ok(unescaped(text)),
            _ => Err(self.error(format!("{name} is not a text")).hint(format!("{name} \"…\""))),
        };
        Lexer::at_line(text, *line).map(unquoted).collect()
    }
}

/// Words of a value with their lines. A text in quotes counts as a quote, which is no number.
pub(super) struct Words<'a>(Lexer<'a>);

impl<'a> Iterator for Words<'a> {
    type Item = (&'a [u8], usize);

    fn next(&mut self) -> Option<Self::Item> {
        let token = self.0.next()?;
        Some((if let Token::Word(word) = token { word } else { b"\"" }, self.0.line()))
    }
}

fn finite(word: &[u8], line: usize, name: &str, file: &Path) -> Result<f64> {
    number(word).filter(|n| n.is_finite()).ok_or_else(|| {
        let what = format!("`{}` in {name} is not a finite number", show(word));
        Diagnostic::new(file, line, what).hint("a decimal number such as 0.25")
    })
}
