//! The header of a VRML file, and files compressed with gzip.

use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

use flate2::read::MultiGzDecoder;

use crate::tokens::{Lines, show};
use crate::{Diagnostic, input};

const MAGIC: &[u8] = b"#VRML";
const GZIP: &[u8] = &[0x1f, 0x8b];

/// Size up to which any compressed file may grow, bytes.
const MAX_UNPACKED: usize = 64 << 20;
/// Largest ratio of the unpacked to the compressed size above [`MAX_UNPACKED`]. Text of numbers has about 3.
const MAX_RATIO: usize = 50;

/// Whether a file is VRML of any version, as text or compressed with gzip.
pub(crate) fn is_header(bytes: &[u8]) -> bool {
    if !bytes.starts_with(GZIP) {
        return strip_mark(bytes).trim_ascii_start().starts_with(MAGIC);
    }
    let mut head = Vec::new();
    // A damaged file may still have given its first bytes.
    let _ = MultiGzDecoder::new(bytes).take(64).read_to_end(&mut head);
    strip_mark(&head).trim_ascii_start().starts_with(MAGIC)
}

/// Returns the text of a VRML 2 file, unpacked.
pub(super) fn text<'a>(bytes: &'a [u8], file: &Path) -> Result<Cow<'a, [u8]>, Diagnostic> {
    let unpacked = unpack(bytes, file)?;
    input::check_content(&unpacked, file)?;
    let text = match unpacked {
        Cow::Borrowed(bytes) => input::text_bytes(bytes, file)?,
        Cow::Owned(bytes) => Cow::Owned(input::text_bytes(&bytes, file)?.into_owned()),
    };
    check_version(&text, file)?;
    Ok(text)
}

fn strip_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

fn unpack<'a>(bytes: &'a [u8], file: &Path) -> Result<Cow<'a, [u8]>, Diagnostic> {
    if !bytes.starts_with(GZIP) {
        return Ok(Cow::Borrowed(bytes));
    }
    let limit = MAX_UNPACKED.max(bytes.len().saturating_mul(MAX_RATIO));
    let mut text = Vec::new();
    MultiGzDecoder::new(bytes).take(limit as u64 + 1).read_to_end(&mut text).map_err(|e| {
        Diagnostic::new(file, None, format!("is damaged: gzip cannot unpack it: {e}"))
            .hint("copy or export the file again")
    })?;
    if text.len() > limit {
        let what = format!("unpacks to more than {limit} bytes from {}", bytes.len());
        return Err(Diagnostic::new(file, None, what).hint("a coarser mesh, or the file unpacked: gunzip FILE"));
    }
    Ok(Cow::Owned(text))
}

fn check_version(text: &[u8], file: &Path) -> Result<(), Diagnostic> {
    let (line, header) = Lines::new(text).find(|(_, l)| !l.trim_ascii().is_empty()).unwrap_or((1, b""));
    let mut words = header.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty());
    let [magic, version, encoding] = [(); 3].map(|()| words.next().unwrap_or_default());
    if magic == MAGIC && version == b"V2.0" && encoding.eq_ignore_ascii_case(b"utf8") {
        return Ok(());
    }
    if magic == MAGIC && version.starts_with(b"V1") {
        return Err(Diagnostic::new(file, line, "is VRML 1.0, whose nodes are not those of VRML 2")
            .hint("the model exported again as VRML 2 (VRML97), or as STL, OBJ, DAE or glTF"));
    }
    let what = format!("begins with `{}`, not with the header of VRML 2", show(header.trim_ascii()));
    Err(Diagnostic::new(file, line, what).hint("#VRML V2.0 utf8"))
}
