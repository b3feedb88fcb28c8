//! The body: numbers one after the other, in words or in bytes.

use std::path::Path;

use super::header::{Element, Encoding, Kind, Property};
use crate::FormatError;
use crate::scan::{Words, number, show};

pub(super) struct Values<'a> {
    encoding: Encoding,
    words: Words<'a>,
    bytes: &'a [u8],
    file: &'a Path,
}

impl<'a> Values<'a> {
    pub(super) fn new(body: &'a [u8], encoding: Encoding, header_lines: usize, file: &'a Path) -> Self {
        Self { encoding, words: Words::at_line(body, header_lines + 1), bytes: body, file }
    }

    pub(super) fn error(&self, what: String) -> FormatError {
        let line = (self.encoding == Encoding::Ascii).then(|| self.words.line());
        FormatError::new(self.file, line, what)
    }

    pub(super) fn error_at(&self, line: usize, what: String) -> FormatError {
        FormatError::new(self.file, line, what)
    }

    /// Refuses an element of which the rest of the file cannot hold as many as announced.
    pub(super) fn check_room(&self, element: &Element) -> Result<(), FormatError> {
        let (left, least) = if self.encoding == Encoding::Ascii {
            // A digit and a blank each; the last blank may be missing.
            (self.words.rest().len() + 1, 2 * element.properties.len())
        } else {
            let size = |p: &Property| p.list_count.unwrap_or(p.kind).size();
            (self.bytes.len(), element.properties.iter().map(size).sum())
        };
        if element.count.saturating_mul(least) > left {
            let what = format!(
                "{} × `{}` are announced, but the file has only {left} bytes left for them",
                element.count, element.name
            );
            return Err(self.error_at(element.line, what).hint("the true count; or copy or export the file again"));
        }
        Ok(())
    }

    pub(super) fn scalar(&mut self, kind: Kind) -> Result<f64, FormatError> {
        if self.encoding == Encoding::Ascii {
            let word = self.words.next().ok_or_else(|| self.truncated())?;
            return number(word)
                .ok_or_else(|| self.error(format!("`{}` is not a number", show(word))).hint("a decimal number"));
        }
        let Some((raw, rest)) = self.bytes.split_at_checked(kind.size()) else {
            return Err(self.truncated());
        };
        self.bytes = rest;
        let mut le = [0; 8];
        le[..raw.len()].copy_from_slice(raw);
        if self.encoding == Encoding::BigEndian {
            le[..raw.len()].reverse();
        }
        Ok(decode(kind, le))
    }

    fn truncated(&self) -> FormatError {
        self.error("the file ends before all announced elements".into()).hint("copy or export the file again")
    }

    fn list_length(&mut self, count: Kind) -> Result<usize, FormatError> {
        let n = self.scalar(count)?;
        let left = if self.encoding == Encoding::Ascii { self.words.rest().len() } else { self.bytes.len() };
        if n >= 0.0 && n.fract() == 0.0 && n <= left as f64 {
            return Ok(n as usize);
        }
        Err(self
            .error(format!("a list of {n} values, with {left} bytes left"))
            .hint("the true count; or export the file again"))
    }

    pub(super) fn list(&mut self, property: &Property, out: &mut Vec<f64>) -> Result<(), FormatError> {
        let n = self.list_length(property.list_count.unwrap_or(Kind::U8))?;
        for _ in 0..n {
            let value = self.scalar(property.kind)?;
            if value.fract() != 0.0 {
                return Err(self
                    .error(format!("the corner {value} of a face is no whole number"))
                    .hint("numbers of vertices, counted from 0"));
            }
            out.push(value);
        }
        Ok(())
    }

    pub(super) fn skip(&mut self, property: &Property) -> Result<(), FormatError> {
        let n = property.list_count.map_or(Ok(1), |count| self.list_length(count))?;
        for _ in 0..n {
            self.scalar(property.kind)?;
        }
        Ok(())
    }
}

fn decode(kind: Kind, le: [u8; 8]) -> f64 {
    let [a, b, c, d, ..] = le;
    match kind {
        Kind::I8 => f64::from(a.cast_signed()),
        Kind::U8 => f64::from(a),
        Kind::I16 => f64::from(i16::from_le_bytes([a, b])),
        Kind::U16 => f64::from(u16::from_le_bytes([a, b])),
        Kind::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
        Kind::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
        Kind::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
        Kind::F64 => f64::from_le_bytes(le),
    }
}
