//! Page templates with parts in double braces.

use std::io::{self, Write};

/// Writes a template. `part` writes the part with a name, and returns false for an unknown name.
///
/// # Errors
/// Errors of `out`; a part that the page does not have.
pub fn fill<W: Write>(
    mut out: W,
    template: &str,
    mut part: impl FnMut(&str, &mut W) -> io::Result<bool>,
) -> io::Result<()> {
    for piece in template.split("{{") {
        let (name, rest) = piece.split_once("}}").unwrap_or(("", piece));
        if !name.is_empty() && !part(name, &mut out)? {
            return Err(io::Error::other(format!("the page has no part called {name}")));
        }
        out.write_all(rest.as_bytes())?;
    }
    out.flush()
}
