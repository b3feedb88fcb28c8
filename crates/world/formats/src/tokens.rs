//! Lines, tokens and numbers of a text file, with their line numbers.

use std::path::Path;

use elbowroom_spatial::Vec3;

use crate::Diagnostic;

/// Tokens of a text, separated by white space. `\n`, `\r\n` and a lone `\r` end a line.
#[derive(Debug, Clone)]
pub(crate) struct Tokens<'a> {
    bytes: &'a [u8],
    position: usize,
    line: usize,
}

impl<'a> Tokens<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self::at_line(bytes, 1)
    }

    pub(crate) fn at_line(bytes: &'a [u8], line: usize) -> Self {
        Self { bytes, position: 0, line }
    }

    /// The line of the last token, counted from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    pub(crate) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.position..]
    }

    /// The rest of the current line, without its ending.
    pub(crate) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = self.rest();
        let length = rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(rest.len());
        self.position += length;
        rest[..length].trim_ascii()
    }

    pub(crate) fn peek(&self) -> Option<&'a [u8]> {
        self.clone().next()
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        while let Some(&b) = self.bytes.get(self.position) {
            if !b.is_ascii_whitespace() {
                let rest = self.rest();
                let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
                self.position += length;
                return Some(&rest[..length]);
            }
            let is_ending = b == b'\n' || (b == b'\r' && self.bytes.get(self.position + 1) != Some(&b'\n'));
            self.line += usize::from(is_ending);
            self.position += 1;
        }
        None
    }
}

/// Lines of a text with their numbers.
pub(crate) struct Lines<'a> {
    bytes: &'a [u8],
    line: usize,
}

impl<'a> Lines<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, line: 0 }
    }

    pub(crate) fn remaining_bytes(&self) -> usize {
        self.bytes.len()
    }

    /// Number of the last returned line.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    /// The next line that is not blank after its comment (`#`) is removed.
    pub(crate) fn next_content(&mut self) -> Option<(usize, &'a [u8])> {
        for (line, text) in self.by_ref() {
            let content = text.split(|&b| b == b'#').next().unwrap_or(text).trim_ascii();
            if !content.is_empty() {
                return Some((line, content));
            }
        }
        None
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a [u8]);

    fn next(&mut self) -> Option<(usize, &'a [u8])> {
        if self.bytes.is_empty() {
            return None;
        }
        self.line += 1;
        let length = self.bytes.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.bytes.len());
        let (line, rest) = self.bytes.split_at(length);
        self.bytes = rest.strip_prefix(b"\r\n").unwrap_or_else(|| rest.get(1..).unwrap_or(&[]));
        Some((self.line, line))
    }
}

/// Parses a decimal number, or `nan` and `inf`.
pub(crate) fn number(word: &[u8]) -> Option<f64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

pub(crate) fn integer(word: &[u8]) -> Option<i64> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// Formats a token for a message: short and printable.
pub(crate) fn show(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(60)]);
    let mut shown: String = text.chars().take(40).map(|c| if c.is_control() { '?' } else { c }).collect();
    if word.len() > shown.len() {
        shown.push('…');
    }
    shown
}

/// Formats a name for a message. Only unusually long names are shortened.
pub(crate) fn show_name(name: &str) -> String {
    const MAX_CHARS: usize = 200;
    let mut shown: String = name.chars().take(MAX_CHARS).map(|c| if c.is_control() { '?' } else { c }).collect();
    if name.chars().nth(MAX_CHARS).is_some() {
        shown.push('…');
    }
    shown
}

/// Reads three finite numbers from the next tokens.
pub(crate) fn vector<'a>(
    words: &mut impl Iterator<Item = &'a [u8]>,
    file: &Path,
    line: usize,
    of: &str,
) -> Result<Vec3, Diagnostic> {
    let mut v = [0.0; 3];
    for (axis, name) in v.iter_mut().zip(["x", "y", "z"]) {
        let word = words
            .next()
            .ok_or_else(|| Diagnostic::new(file, line, format!("{of} has no {name}")).hint("three numbers: x y z"))?;
        *axis = number(word).ok_or_else(|| {
            Diagnostic::new(file, line, format!("`{}` is not a number, for {name} of {of}", show(word)))
                .hint("a decimal number such as 0.25")
        })?;
        if !axis.is_finite() {
            return Err(Diagnostic::new(
                file,
                line,
                format!("{name} of {of} is `{}`, which is not finite", show(word)),
            )
            .hint("a finite number; export the mesh again, or delete the vertex and its faces"));
        }
    }
    Ok(v.into())
}

/// Index from byte offsets to line numbers.
pub(crate) struct LineIndex {
    /// Offset of the first byte of each line after the first.
    starts: Vec<usize>,
}

impl LineIndex {
    pub(crate) fn new(text: &str) -> Self {
        Self { starts: text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1).collect() }
    }

    /// The line of a byte, counted from 1.
    pub(crate) fn line_at(&self, offset: usize) -> usize {
        self.starts.partition_point(|&start| start <= offset) + 1
    }
}
