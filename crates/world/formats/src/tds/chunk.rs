//! Nested chunks and their numbers; every length is checked against the enclosing chunk.

use std::path::Path;

use elbowroom_spatial::Vec3;

use crate::Diagnostic;

/// Size of id and length, bytes.
const HEAD: usize = 6;

/// A chunk: an id and its bytes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chunk<'a> {
    pub(super) id: u16,
    body: &'a [u8],
    /// Offset of the body in the file.
    at: usize,
}

/// The chunk of the whole file. Its length is ignored if it does not fit: some writers leave it at 0.
pub(super) fn main<'a>(bytes: &'a [u8], file: &Path) -> Result<Chunk<'a>, Diagnostic> {
    if bytes.len() < HEAD || !bytes.starts_with(&[0x4d, 0x4d]) {
        return Err(Diagnostic::new(file, None, "is no 3DS file: it does not begin with the bytes 4D 4D")
            .hint("a model saved as .3ds by 3D Studio, 3ds Max or another program"));
    }
    let length = u32::from_le_bytes([bytes[2], bytes[3], bytes[4], bytes[5]]) as usize;
    let end = if (HEAD..=bytes.len()).contains(&length) { length } else { bytes.len() };
    Ok(Chunk { id: 0x4d4d, body: &bytes[HEAD..end], at: HEAD })
}

impl<'a> Chunk<'a> {
    pub(super) fn children<'f>(&self, file: &'f Path) -> Children<'a, 'f> {
        self.cursor(file).children()
    }

    pub(super) fn cursor<'f>(&self, file: &'f Path) -> Cursor<'a, 'f> {
        Cursor { rest: self.body, at: self.at, id: self.id, file }
    }
}

/// Consecutive chunks.
pub(super) struct Children<'a, 'f> {
    cursor: Cursor<'a, 'f>,
}

impl<'a> Iterator for Children<'a, '_> {
    type Item = Result<Chunk<'a>, Diagnostic>;

    fn next(&mut self) -> Option<Self::Item> {
        // Some writers pad with a few bytes.
        if self.cursor.rest.len() < HEAD {
            return None;
        }
        let chunk = self.cursor.chunk();
        if chunk.is_err() {
            self.cursor.rest = &[];
        }
        Some(chunk)
    }
}

/// Reader of consecutive numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cursor<'a, 'f> {
    rest: &'a [u8],
    at: usize,
    id: u16,
    file: &'f Path,
}

impl<'a, 'f> Cursor<'a, 'f> {
    pub(super) fn error(&self, what: &str) -> Diagnostic {
        Diagnostic::new(self.file, None, format!("chunk {:04X}, byte {}: {what}", self.id, self.at))
    }

    pub(super) fn children(self) -> Children<'a, 'f> {
        Children { cursor: self }
    }

    fn chunk(&mut self) -> Result<Chunk<'a>, Diagnostic> {
        let (id, length) = (self.u16()?, self.u32()? as usize);
        let Some(body) = length.checked_sub(HEAD).and_then(|n| self.rest.get(..n)) else {
            let left = self.rest.len() + HEAD;
            let what = format!("a chunk {id:04X} claims {length} bytes where {left} are left");
            return Err(self.error(&what).hint("the whole file: copy or export it again"));
        };
        let chunk = Chunk { id, body, at: self.at };
        self.skip(body.len())?;
        Ok(chunk)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Diagnostic> {
        let Some((first, rest)) = self.rest.split_first_chunk::<N>() else {
            return Err(self.error("ends too early").hint("the whole file: copy or export it again"));
        };
        self.rest = rest;
        self.at += N;
        Ok(*first)
    }

    pub(super) fn skip(&mut self, bytes: usize) -> Result<(), Diagnostic> {
        let Some(rest) = self.rest.get(bytes..) else {
            return Err(self.error("ends too early").hint("the whole file: copy or export it again"));
        };
        self.rest = rest;
        self.at += bytes;
        Ok(())
    }

    /// Checks a count of elements of `bytes_each` bytes against the remaining bytes.
    pub(super) fn count(&self, count: usize, bytes_each: usize, of: &str) -> Result<usize, Diagnostic> {
        if self.rest.len() / bytes_each < count {
            let what = format!("claims {count} {of}, and has bytes for {}", self.rest.len() / bytes_each);
            return Err(self.error(&what).hint("the whole file: copy or export it again"));
        }
        Ok(count)
    }

    pub(super) fn u16(&mut self) -> Result<u16, Diagnostic> {
        self.take().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, Diagnostic> {
        self.take().map(u32::from_le_bytes)
    }

    /// Reads a finite number.
    pub(super) fn f32(&mut self) -> Result<f32, Diagnostic> {
        let number = self.take().map(f32::from_le_bytes)?;
        if number.is_finite() {
            return Ok(number);
        }
        Err(self.error(&format!("has a number that is not finite: {number}")).hint("finite numbers; export again"))
    }

    pub(super) fn vector(&mut self) -> Result<Vec3, Diagnostic> {
        Ok(Vec3::new(f64::from(self.f32()?), f64::from(self.f32()?), f64::from(self.f32()?)))
    }

    /// Reads a text that ends with a zero byte; one byte is one character.
    pub(super) fn text(&mut self) -> Result<String, Diagnostic> {
        let Some(length) = self.rest.iter().position(|&b| b == 0) else {
            return Err(self.error("has a name without an end").hint("the whole file: copy or export it again"));
        };
        let printable = |b: &u8| if b.is_ascii_control() { '_' } else { char::from(*b) };
        let text = self.rest[..length].iter().map(printable).collect();
        self.skip(length + 1)?;
        Ok(text)
    }
}
