//! Bytes of a file, with the mix-ups that every format shares caught at the door.

use std::borrow::Cow;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use crate::FormatError;

/// Larger files are refused: no robot needs them, and memory is bounded by it.
pub(crate) const MAX_BYTES: u64 = 1 << 30;

/// Reads a regular file whole; refuses directories, devices and pipes, which may never end.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, FormatError> {
    let cannot = |e: std::io::Error| FormatError::new(path, None, format!("cannot be read: {e}"));
    let meta = std::fs::metadata(path).map_err(cannot)?;
    if !meta.is_file() {
        return Err(FormatError::new(path, None, "is not a file").hint("the path of a file, not of a directory"));
    }
    if meta.len() > MAX_BYTES {
        return Err(FormatError::new(
            path,
            None,
            format!("has {} bytes, more than the {MAX_BYTES} allowed", meta.len()),
        )
        .hint("a coarser mesh: collision checking needs thousands of triangles, not millions"));
    }
    let mut bytes = Vec::with_capacity(meta.len() as usize);
    File::open(path).and_then(|f| f.take(MAX_BYTES).read_to_end(&mut bytes)).map_err(cannot)?;
    Ok(bytes)
}

/// Refuses what no reader can use: nothing at all, Git LFS pointers, archives.
pub(crate) fn check_content(bytes: &[u8], file: &Path) -> Result<(), FormatError> {
    let refuse = |what: &str, hint: &str| Err(FormatError::new(file, None, what).hint(hint));
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return refuse("is empty", "export the model again: nothing arrived in the file");
    }
    if bytes.starts_with(b"version https://git-lfs") {
        return Err(FormatError::new(file, 1, "is a Git LFS pointer, not the file itself")
            .hint("run `git lfs pull` in the repository that it came from"));
    }
    if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
        return refuse("is a zip archive (.zae, .3mf and the like)", "unpack it and name the .dae or .stl inside");
    }
    if bytes.starts_with(&[0x1f, 0x8b]) {
        return refuse("is compressed with gzip", "unpack it first: gunzip FILE");
    }
    Ok(())
}

/// The text of a file: UTF-8, or UTF-16 where a byte order mark or an XML opening gives it away, or Latin-1 where the
/// XML declaration says so.
pub(crate) fn text<'a>(bytes: &'a [u8], file: &Path) -> Result<Cow<'a, str>, FormatError> {
    if let Some(rest) = bytes.strip_prefix(b"\xef\xbb\xbf") {
        return utf8(rest, file);
    }
    match bytes {
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes, file),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes, file),
        [b'<', 0, ..] => utf16(bytes, u16::from_le_bytes, file),
        [0, b'<', ..] => utf16(bytes, u16::from_be_bytes, file),
        _ => utf8(bytes, file),
    }
}

fn utf8<'a>(bytes: &'a [u8], file: &Path) -> Result<Cow<'a, str>, FormatError> {
    let error = match std::str::from_utf8(bytes) {
        Ok(text) => return Ok(Cow::Borrowed(text)),
        Err(e) => e,
    };
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).to_ascii_lowercase();
    if head.starts_with("<?xml") && (head.contains("iso-8859-1") || head.contains("windows-1252")) {
        return Ok(Cow::Owned(bytes.iter().map(|&b| b as char).collect()));
    }
    let line = bytes[..error.valid_up_to()].split(|&b| b == b'\n').count();
    Err(FormatError::new(file, line, "is not text: a byte here is not UTF-8").hint("save the file as UTF-8"))
}

fn utf16<'a>(bytes: &[u8], unit: fn([u8; 2]) -> u16, file: &Path) -> Result<Cow<'a, str>, FormatError> {
    let units = bytes.chunks_exact(2).map(|c| unit([c[0], c[1]]));
    let text: Result<String, _> = char::decode_utf16(units).collect();
    text.map(Cow::Owned)
        .map_err(|_| FormatError::new(file, None, "is not sound UTF-16 text").hint("save the file as UTF-8"))
}

/// The same bytes where they are UTF-8 or something like it, decoded where they are UTF-16; no byte order mark.
pub(crate) fn text_bytes<'a>(bytes: &'a [u8], file: &Path) -> Result<Cow<'a, [u8]>, FormatError> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return text(bytes, file).map(|t| Cow::Owned(t.into_owned().into_bytes()));
    }
    Ok(Cow::Borrowed(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)))
}

/// The name of a file without directory and extension.
pub(crate) fn stem(file: &Path) -> String {
    file.file_stem().map_or_else(|| "mesh".to_owned(), |s| s.to_string_lossy().into_owned())
}
