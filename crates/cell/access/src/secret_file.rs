//! Files with one secret, which only their owner may read.

use std::fs::File;
use std::io::{self, Write as _};
use std::path::Path;

use elbowroom_formats::Diagnostic;
use elbowroom_formats::toml_tables::{self, Table};

use crate::result::Result;
use crate::{hex, text_file};

/// 256 bits from the operating system.
pub(crate) fn random() -> io::Result<[u8; 32]> {
    let mut secret = [0; 32];
    getrandom::fill(&mut secret).map_err(|e| io::Error::other(e.to_string()))?;
    Ok(secret)
}

/// Writes `name = "…"` below a comment to a new file (mode 0600).
pub(crate) fn write(path: &Path, comment: &str, name: &str, secret: &[u8; 32]) -> io::Result<()> {
    let mut file = create(path)?;
    write!(file, "# {comment}\n{name} = \"{}\"\n", hex::encode(secret))?;
    file.sync_all()
}

/// Reads what [`write`] has written; `origin` says what writes such a file.
pub(crate) fn read(path: &Path, name: &str, origin: &str) -> Result<[u8; 32]> {
    check_private_permissions(path)?;
    let text = text_file::read(path)?;
    let entries = toml_tables::parse(path, &text)?;
    let table = Table { file: path, name: String::new(), line: 1, entries: &entries };
    table.only(&[name])?;
    let secret = table.need(name, origin)?;
    let bytes = hex::decode(secret.text()?);
    bytes.ok_or_else(|| secret.error("is no key").hint(format!("64 hexadecimal digits, {origin}")))
}

#[cfg(unix)]
pub(crate) fn create(path: &Path) -> io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    File::options().write(true).create_new(true).mode(0o600).open(path)
}

#[cfg(not(unix))]
pub(crate) fn create(path: &Path) -> io::Result<File> {
    File::options().write(true).create_new(true).open(path)
}

/// Checks that only its owner may read or write a file with a secret.
///
/// A missing file passes; the function that reads it reports the error.
///
/// # Errors
/// An error if others may read or write the file.
#[cfg(unix)]
pub fn check_private_permissions(path: &Path) -> Result<()> {
    use std::os::unix::fs::PermissionsExt;
    let Ok(about) = std::fs::metadata(path) else { return Ok(()) };
    let mode = about.permissions().mode() & 0o777;
    if mode.trailing_zeros() >= 6 {
        return Ok(());
    }
    let what = format!("is a secret key that others may read or write (mode {mode:03o})");
    Err(Diagnostic::new(path, None, what).hint(format!("chmod 600 {}", path.display())))
}

#[cfg(not(unix))]
pub fn check_private_permissions(_: &Path) -> Result<()> {
    Ok(())
}
