//! The body: consecutive numbers, in text or binary form.

use std::path::Path;

use super::header::{Element, Encoding, Property, ScalarType};
use crate::Diagnostic;
use crate::tokens::{Tokens, number, show};

pub(super) struct BodyReader<'a> {
    encoding: Encoding,
    tokens: Tokens<'a>,
    bytes: &'a [u8],
    file: &'a Path,
}

impl<'a> BodyReader<'a> {
    pub(super) fn new(body: &'a [u8], encoding: Encoding, header_lines: usize, file: &'a Path) -> Self {
        Self { encoding, tokens: Tokens::at_line(body, header_lines + 1), bytes: body, file }
    }

    pub(super) fn error(&self, what: String) -> Diagnostic {
        let line = (self.encoding == Encoding::Ascii).then(|| self.tokens.line());
        Diagnostic::new(self.file, line, what)
    }

    pub(super) fn error_at(&self, line: usize, what: String) -> Diagnostic {
        Diagnostic::new(self.file, line, what)
    }

    /// Refuses an element whose count is larger than the rest of the file can hold.
    pub(super) fn check_remaining(&self, element: &Element) -> Result<(), Diagnostic> {
        let (left, least) = if self.encoding == Encoding::Ascii {
            // At least a digit and a blank for each value; the last blank may be missing.
            (self.tokens.rest().len() + 1, 2 * element.properties.len())
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

    pub(super) fn scalar(&mut self, kind: ScalarType) -> Result<f64, Diagnostic> {
        if self.encoding == Encoding::Ascii {
            let word = self.tokens.next().ok_or_else(|| self.truncated())?;
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

    fn truncated(&self) -> Diagnostic {
        self.error("the file ends before all announced elements".into()).hint("copy or export the file again")
    }

    fn list_length(&mut self, count: ScalarType) -> Result<usize, Diagnostic> {
        let n = self.scalar(count)?;
        let left = if self.encoding == Encoding::Ascii { self.tokens.rest().len() } else { self.bytes.len() };
        if n >= 0.0 && n.fract() == 0.0 && n <= left as f64 {
            return Ok(n as usize);
        }
        Err(self
            .error(format!("a list of {n} values, with {left} bytes left"))
            .hint("the true count; or export the file again"))
    }

    pub(super) fn list(&mut self, property: &Property, out: &mut Vec<f64>) -> Result<(), Diagnostic> {
        let n = self.list_length(property.list_count.unwrap_or(ScalarType::U8))?;
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

    pub(super) fn skip(&mut self, property: &Property) -> Result<(), Diagnostic> {
        let n = property.list_count.map_or(Ok(1), |count| self.list_length(count))?;
        for _ in 0..n {
            self.scalar(property.kind)?;
        }
        Ok(())
    }
}

fn decode(kind: ScalarType, le: [u8; 8]) -> f64 {
    let [a, b, c, d, ..] = le;
    match kind {
        ScalarType::I8 => f64::from(a.cast_signed()),
        ScalarType::U8 => f64::from(a),
        ScalarType::I16 => f64::from(i16::from_le_bytes([a, b])),
        ScalarType::U16 => f64::from(u16::from_le_bytes([a, b])),
        ScalarType::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
        ScalarType::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
        ScalarType::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
        ScalarType::F64 => f64::from_le_bytes(le),
    }
}
