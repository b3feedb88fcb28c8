//! The header of a VRML file.

use std::borrow::Cow;
use std::path::Path;

use crate::tokens::{Lines, show};
use crate::{Diagnostic, input};

const MAGIC: &[u8] = b"#VRML";

/// Whether a file is VRML of any version.
pub(crate) fn is_header(bytes: &[u8]) -> bool {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start().starts_with(MAGIC)
}

/// Returns the text of a VRML 2 file.
pub(super) fn text<'a>(bytes: &'a [u8], file: &Path) -> Result<Cow<'a, [u8]>, Diagnostic> {
    input::check_content(bytes, file)?;
    let text = input::text_bytes(bytes, file)?;
    check_version(&text, file)?;
    Ok(text)
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
